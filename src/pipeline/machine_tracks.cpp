// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/machine_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "pipeline/part_look.h"

namespace swage {

// Frame 1, the start, is in no stage and has the first one's machine.
std::string stage_of_machine(const std::vector<StageFrames>& stages, int machine, int first_frame) {
    for (const StageFrames& stage : stages) {
        if (first_frame <= stage.last) return stage.name;
    }
    return fmt::format("machine-{}", machine + 1);
}

void MachineTracks::look_at(int frame, const StoredFrame& stored, MeshLooks& looks) {
    const auto known = std::find_if(machine_.begin(), machine_.end(),
                                    [&](const Machine& one) { return one.id == stored.machine; });
    Machine* machine = known == machine_.end() ? nullptr : &*known;
    if (machine == nullptr) {
        if (stored.machine < 0 || stored.machine >= store_.machine_count()) return;
        machine = &machine_.emplace_back(Machine{stored.machine, frame, {}, {}});
        machine->is_seen.assign(std::size_t(frames_.last - frames_.first + 1), 0);
        std::vector<DrawnPart> parts = store_.machine(stored.machine);
        for (std::size_t n = 0; n < parts.size(); ++n) {
            const std::optional<SurfaceMaterial> look = look_of(parts[n], settings_);
            if (!look) continue;
            machine->part.push_back({std::move(parts[n]), looks.of_plain(*look), n, {}});
        }
    }
    machine->is_seen.at(std::size_t(frame - frames_.first)) = 1;
    for (Part& part : machine->part) {
        const Pose& pose = stored.pose.at(part.number);
        part.pose.resize(std::size_t(frame - machine->first), pose);
        part.pose.push_back(pose);
        const Box own = box_of(part.drawn.surface.position);
        for (int c = 0; c < 8; ++c) {
            (part.drawn.finish == Finish::endless ? endless_ : box_).grow(pose * own.corner(c));
        }
    }
}

std::size_t MachineTracks::count() const {
    std::size_t parts = 0;
    for (const Machine& machine : machine_) parts += machine.part.size();
    return parts;
}

Box MachineTracks::box(bool endless) const {
    Box box = box_;
    if (endless) box.grow(endless_);
    return box;
}

}  // namespace swage
