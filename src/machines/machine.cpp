// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine.h"

#include "machines/load_name.h"
#include "machines/told_at.h"

namespace swage {

namespace {

template <typename Part>
std::vector<Pose> placed(const Machine& machine, const char* kind, const std::vector<Part>& part,
                         const std::vector<Pose>& work_from_part, const std::vector<Motion>& motion,
                         double t) {
    std::vector<Pose> world_from_part;
    for (std::size_t n = 0; n < motion.size(); ++n) {
        const Pose moved =
            pose_at(motion[n], fmt::format("{} {}", kind, part[n].name), t, machine.stop);
        world_from_part.push_back(machine.frame.world_from_work * moved * work_from_part[n]);
    }
    return world_from_part;
}

}  // namespace

std::vector<std::optional<TurnAxis>> turn_axes(const Machine& machine) {
    std::vector<std::optional<TurnAxis>> axes;
    const auto add = [&](const std::vector<Pose>& work_from_part,
                         const std::vector<Motion>& motion) {
        for (std::size_t n = 0; n < motion.size(); ++n) {
            const Pose part_from_work = work_from_part[n].inverse();
            axes.emplace_back();
            if (!motion[n].turns()) continue;
            axes.back() = {part_from_work.turn(motion[n].axis()),
                           part_from_work * motion[n].pivot_at(0)};
        }
    };
    add(machine.work_from_tool, machine.tool_motion);
    add(machine.work_from_grip, machine.grip_motion);
    return axes;
}

std::vector<double> strengths_at(const Machine& machine, double t) {
    const Apparatus& apparatus = machine.apparatus;
    return naming(machine.spec, [&] {
        std::vector<double> strength;
        for (std::size_t n = 0; n < machine.load_strength.size(); ++n) {
            strength.push_back(
                told_at("the strength of " + load_name(apparatus.load[n].name), t,
                        [&] { return machine.load_strength[n].at(t, machine.stop); }));
        }
        strength.push_back(told_at("gravity_strength", t, [&] {
            return machine.gravity_strength ? machine.gravity_strength->at(t, machine.stop) : 1.0;
        }));
        return strength;
    });
}

Drive drive_at(const Machine& machine, double t, double duration) {
    const Apparatus& apparatus = machine.apparatus;
    std::vector<double> strength = strengths_at(machine, t);
    const double gravity = strength.back();
    strength.pop_back();
    return naming(machine.spec, [&] {
        return Drive{
            t * duration,
            placed(machine, "tool", apparatus.tool, machine.work_from_tool, machine.tool_motion, t),
            placed(machine, "grip", apparatus.grip, machine.work_from_grip, machine.grip_motion, t),
            placed(machine, "blade", apparatus.blade, machine.work_from_blade, machine.blade_motion,
                   t),
            std::move(strength),
            gravity};
    });
}

}  // namespace swage
