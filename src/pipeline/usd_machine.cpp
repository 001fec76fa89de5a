// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/usd_machine.h"

#include <algorithm>

#include "geometry/usd_mesh.h"
#include "geometry/usd_time.h"
#include "pipeline/part_look.h"

namespace swage {

// Frame 1, the start, is in no stage and has the first one's machine.
std::string stage_of_machine(const std::vector<UsdStage>& stages, int machine, int first_frame) {
    for (const UsdStage& stage : stages) {
        if (first_frame <= stage.last) return stage.name;
    }
    return fmt::format("machine-{}", machine + 1);
}

void UsdMachines::look_at(int frame, const StoredFrame& stored, UsdLooks& looks) {
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

std::size_t UsdMachines::count() const {
    std::size_t parts = 0;
    for (const Machine& machine : machine_) parts += machine.part.size();
    return parts;
}

Box UsdMachines::box(bool endless) const {
    Box box = box_;
    if (endless) box.grow(endless_);
    return box;
}

void UsdMachines::write(UsdText& out, const std::string& materials, const UsdLooks& looks) const {
    if (count() == 0) return;
    out.open("def Scope \"machine\"");
    std::set<std::string> taken;
    for (const Machine& machine : machine_) {
        if (machine.part.empty()) continue;
        const std::string name = stage_of_machine(stages_, machine.id, machine.first);
        out.open(usd_prim("Scope", name, usd_identifier(name, taken)));
        write(out, machine, materials, looks);
        out.close();
    }
    out.close();
}

void UsdMachines::write(UsdText& out, const Machine& machine, const std::string& materials,
                        const UsdLooks& looks) const {
    const std::vector<char>& is_seen = machine.is_seen;
    if (std::find(is_seen.begin(), is_seen.end(), 0) != is_seen.end()) {
        out.value(
            "token visibility", "", changes(is_seen, frames_.first, Between::held), [&](int frame) {
                out.word(is_seen[std::size_t(frame - frames_.first)] ? "inherited" : "invisible");
            });
    }
    std::set<std::string> taken;
    for (const Part& part : machine.part) {
        const std::string& name = part.drawn.name;
        out.open(usd_prim("Mesh", name, usd_identifier(name, taken), kUsdBinds));
        write_usd_surface(out, part.drawn.surface, part.drawn.color);
        out.line(
            fmt::format("rel material:binding = <{}/{}>", materials, looks.identifier(part.look)));
        write_usd_poses(out, machine.first, part.pose);
        out.close();
    }
}

}  // namespace swage
