// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/start_notes.h"

#include <algorithm>

#include "base/units.h"
#include "machines/touch.h"
#include "matter/cell_middle.h"

namespace swage {

namespace {

// Tools that start deeper than this in the work-piece, or turn about what lies farther than this
// from their middle, are noted: share of the spacing.
constexpr double kOff = 0.05;
constexpr int kLooks = 256;      // at a motion
constexpr double kTurns = 1e-8;  // [rad]
constexpr float kWhole = 0.99f;  // share of a cell

std::string length_of(double value) { return quantity_text(value, Quantity::length); }

// At even times; none where an expression has no value: drive_at() tells that.
std::vector<Pose> way_of(const Motion& motion) {
    std::vector<Pose> way;
    try {
        for (int n = 0; n <= kLooks; ++n) way.push_back(motion.at(double(n) / kLooks));
    } catch (const PlacedError&) {
        way.clear();
    }
    return way;
}

std::string pivot_note(const Machine& machine, std::size_t n, double slack) {
    const MotionSpec& motion = machine.spec.tool[n].motion;
    if (motion.says_pivot()) return "";
    const Vec3 middle = machine.work_from_tool[n].translation;
    const Vec3 axis = motion.axis.normalized();
    const double off = (middle - middle.dot(axis) * axis).norm();
    if (off <= slack) return "";
    const std::vector<Pose> way = way_of(machine.tool_motion[n]);
    const bool turns = std::any_of(way.begin(), way.end(), [](const Pose& pose) {
        return rotation_of(pose.rotation).norm() > kTurns;
    });
    if (!turns) return "";
    const std::string& name = machine.apparatus.tool[n].name;
    return fmt::format(
        "tool {0} turns about the middle of the work-piece, {1} from its own: where that is meant, "
        "say pivot = [0, 0, 0] in its motion; pivot = [\"{0}_x\", \"{0}_y\", \"{0}_z\"] turns it "
        "about its own",
        name, length_of(off));
}

// Of cells that no surface passes through, in the work frame [m].
std::vector<Vec3> whole_middles(const Machine& machine, const Aggregate& matter) {
    const Pose work_from_world = machine.frame.world_from_work.inverse();
    std::vector<Vec3> middle;
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        if (matter.cell_fill[c] < kWhole) continue;
        middle.push_back(work_from_world * cell_middle(matter, static_cast<CellId>(c)));
    }
    return middle;
}

// Of one that is not meant to be there.
std::string depth_note(const Machine& machine, std::size_t n, const std::vector<Vec3>& touch,
                       const std::vector<Vec3>& inner, double slack) {
    const ToolSpec& spec = machine.spec.tool[n];
    const bool is_slid = spec.touch != ToolSpec().touch;
    if (is_slid) return "";
    const Tool& tool = machine.apparatus.tool[n];
    const Pose& pose = machine.work_from_tool[n];
    const double deep = -nearest_distance(tool.shape, pose, touch);
    if (deep > slack) {
        return fmt::format("tool {} starts {} deep in the work-piece", tool.name, length_of(deep));
    }
    if (deep < 0 && nearest_distance(tool.shape, pose, inner) < 0) {
        return fmt::format(
            "tool {} starts wholly inside the work-piece, where it meets no surface and pushes "
            "nothing",
            tool.name);
    }
    return "";
}

}  // namespace

std::vector<std::string> start_notes(const Machine& machine, const Aggregate& matter,
                                     const std::vector<Vec3>& touch) {
    std::vector<std::string> notes;
    const auto note = [&](std::string sentence) {
        if (!sentence.empty()) notes.push_back(std::move(sentence));
    };
    const double slack = kOff * matter.lattice.spacing;
    std::vector<Vec3> inner;
    if (!machine.apparatus.tool.empty()) inner = whole_middles(machine, matter);
    for (std::size_t n = 0; n < machine.apparatus.tool.size(); ++n) {
        note(depth_note(machine, n, touch, inner, slack));
        note(pivot_note(machine, n, slack));
    }
    return notes;
}

}  // namespace swage
