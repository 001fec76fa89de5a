// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/start_notes.h"

#include <algorithm>
#include <limits>
#include <map>

#include "base/expression.h"
#include "base/text.h"
#include "base/text_error.h"
#include "base/units.h"
#include "machines/ever_turns.h"
#include "machines/load_name.h"
#include "machines/tool_clash.h"
#include "machines/touch.h"
#include "matter/cell_middle.h"

namespace swage {

namespace {

// Tools that start deeper than this in the work-piece, or turn about what lies farther than this
// from their middle, are noted: share of the spacing.
constexpr double kOff = 0.05;
constexpr int kLooks = 256;     // at a motion
constexpr double kJump = 0.25;  // spacings, in no time
constexpr double kNoTime = 1e-12;
constexpr double kTurns = 1e-8;  // [rad]
constexpr float kFull = 0.99f;   // share of a cell

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

std::string pivot_note(const Machine& machine, std::size_t n, const Vec3& axis,
                       const std::vector<Pose>& way, double slack) {
    if (machine.spec.tool[n].motion.says_pivot()) return "";
    const Vec3 middle = machine.work_from_tool[n].translation;
    const double off = (middle - middle.dot(axis) * axis).norm();
    if (off <= slack) return "";
    const bool turns = std::any_of(way.begin(), way.end(), [](const Pose& pose) {
        return rotation_of(pose.rotation).norm() > kTurns;
    });
    if (!turns) return "";
    const std::string& name = machine.apparatus.tool[n].name;
    return fmt::format(
        "tool {0} turns about the middle of the work-piece, {1} from its own: if that is intended, "
        "give pivot = [0, 0, 0] in its motion; pivot = [\"{0}_x\", \"{0}_y\", \"{0}_z\"] turns it "
        "about its own",
        name, length_of(off));
}

// Of cells that no surface passes through, in the work frame [m].
std::vector<Vec3> whole_middles(const Machine& machine, const Aggregate& matter) {
    const Pose work_from_world = machine.frame.world_from_work.inverse();
    std::vector<Vec3> middle;
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        if (matter.cell_fill[c] < kFull) continue;
        middle.push_back(work_from_world * cell_middle(matter, static_cast<CellId>(c)));
    }
    return middle;
}

// How far two poses are apart for what they move, at the most [m].
double apart(const Pose& a, const Pose& b, const Vec3& middle, double reach) {
    return (a * middle - b * middle).norm() + reach * turn_between(a, b).norm();
}

// `way`: of the motion; `middle`: of what it moves, in the work frame.
std::string jump_note(const std::string& whose, const Motion& motion, const std::vector<Pose>& way,
                      const Vec3& middle, double reach, double least) {
    for (std::size_t n = 1; n < way.size(); ++n) {
        if (apart(way[n - 1], way[n], middle, reach) < least) continue;
        double begin = double(n - 1) / kLooks, end = double(n) / kLooks;
        Pose from = way[n - 1], to = way[n];
        while (end - begin > kNoTime && apart(from, to, middle, reach) >= least) {
            const double half = 0.5 * (begin + end);
            const Pose between = motion.at(half);
            const bool is_later =
                apart(from, between, middle, reach) < apart(between, to, middle, reach);
            (is_later ? begin : end) = half;
            (is_later ? from : to) = between;
        }
        const double jump = apart(from, to, middle, reach);
        if (jump < least) continue;
        return fmt::format(
            "{} jumps by up to {} at t = {:.3g}: use ramp(t, a, b) or line(t, a, b) instead of a "
            "step",
            whose, length_of(jump), end);
    }
    return "";
}

// Where nothing else of the machine moves, and so brings the work-piece to it.
bool only_blades_move(const MachineSpec& spec) {
    MachineSpec rest = spec;
    rest.blade.clear();
    return rest.stands() && rest.load.empty();
}

// Of a blade whose edge stays beside the work-piece's box all its way.
std::string miss_note(const Machine& machine, std::size_t n, const std::vector<Pose>& way,
                      double slack) {
    if (way.empty() || blade_stands(machine, n)) return "";
    const Blade& blade = machine.apparatus.blade[n];
    const Vec3 half = (0.5 * machine.frame.size).array() + slack;
    double nearest = std::numeric_limits<double>::infinity();
    const auto grow = [&](Box& box, const Pose& moved) {
        for (const Vec3& point : blade.edge) box.grow(moved * machine.work_from_blade[n] * point);
    };
    for (std::size_t leg = 1; leg < way.size(); ++leg) {
        Box swept;
        grow(swept, way[leg - 1]);
        grow(swept, way[leg]);
        const Vec3 beside = (swept.low - half).cwiseMax(-half - swept.high).cwiseMax(0);
        nearest = std::min(nearest, beside.norm());
    }
    if (nearest == 0) return "";
    return fmt::format(
        "blade {} misses the work-piece where that is now, by at least {}: it will cut nothing "
        "unless that moves there",
        blade.name, length_of(nearest + slack));
}

// Of one that is not meant to be there: what `touch` has slid up to the work-piece is as deep as
// its gap says, until its motion begins.
std::string depth_note(const Machine& machine, std::size_t n, const std::vector<Vec3>& touch,
                       const std::vector<Vec3>& inner, const Pose& start, double slack) {
    const Tool& tool = machine.apparatus.tool[n];
    const Pose& placed = machine.work_from_tool[n];
    const Pose pose = start * placed;
    const bool is_slid = machine.spec.tool[n].touch != ToolSpec().touch;
    const double meant = is_slid ? -nearest_distance(tool.shape, placed, touch) : 0;
    const double deep = -nearest_distance(tool.shape, pose, touch);
    if (deep > std::max(meant, 0.0) + slack) {
        const bool is_moved =
            apart(start, Pose{}, placed.translation, machine.frame.size.norm()) > slack;
        return fmt::format("tool {} starts {} deep in the work-piece{}", tool.name, length_of(deep),
                           is_moved ? ": its motion is not 0 at t = 0" : "");
    }
    if (deep < 0 && nearest_distance(tool.shape, pose, inner) < 0) {
        return fmt::format(
            "tool {} starts entirely inside the work-piece, where it meets no surface and pushes "
            "nothing",
            tool.name);
    }
    return "";
}

// Of a load whose points are all clamped, so that its grips bear it and nothing else feels it. Of a
// patch that is held in part the load may act on the other part.
std::string clamped_note(const Load& load, const std::vector<Grip>& grips) {
    constexpr double kWhole = 1 - 1e-6;
    std::map<int, double> clamped;
    for (const Grip& grip : grips) {
        if (grip.hold != Vec3::Ones() || grip.body != load.body) continue;
        for (std::size_t n = 0; n < grip.point.size(); ++n) {
            clamped[grip.point[n]] += grip.share_of(n);
        }
    }
    const bool is_free = std::any_of(load.point.begin(), load.point.end(), [&](int point) {
        const auto at = clamped.find(point);
        return at == clamped.end() || at->second < kWhole;
    });
    if (is_free) return "";
    return load_name(load.name) + " does nothing: all that it acts on is clamped";
}

// What knows these alone is judged with a place in its file, as that is read.
bool is_judged_as_read(const Expression& one, const std::vector<std::string>& known) {
    try {
        return one.empty() || (Formula(one.text, known), true);
    } catch (const TextError&) {
        return false;
    }
}

// Of a grip that moves along axes which it does not hold: whatever is there slides by.
std::string across_note(const Machine& machine, std::size_t n, const std::vector<Pose>& way,
                        double slack) {
    const Grip& grip = machine.apparatus.grip[n];
    if (grip.hold == Vec3::Ones() || way.empty() || ever_turns(machine.grip_motion[n])) return "";
    Vec3 most = Vec3::Zero();
    for (const Pose& pose : way) most = most.cwiseMax(pose.translation.cwiseAbs());
    std::vector<std::string> idle, held;
    bool moves = false;
    for (int axis = 0; axis < 3; ++axis) {
        const std::string name(1, "xyz"[axis]);
        if (grip.hold[axis] != 0) {
            held.push_back(name);
            moves = moves || most[axis] > slack;
        } else if (most[axis] > slack) {
            idle.push_back(name);
        }
    }
    if (idle.empty()) return "";
    return fmt::format(
        "grip {} holds along {} alone (along), and moves along {}: what it holds slides past it, "
        "so {}does nothing",
        grip.name, joined(held, " and "), joined(idle, " and "),
        moves ? "that part of its motion " : "its motion ");
}

// Of loads, and gravity, that come to nothing by what the work-piece or a parameter is.
std::vector<std::string> nothing_notes(const Machine& machine) {
    const std::vector<LoadSpec>& spec = machine.spec.load;
    std::vector<double> most(spec.size() + 1, 0.0);
    try {
        for (int look = 0; look <= kLooks; ++look) {
            const std::vector<double> now = strengths_at(machine, double(look) / kLooks);
            for (std::size_t n = 0; n < now.size(); ++n) {
                most[n] = std::max(most[n], std::abs(now[n]));
            }
        }
    } catch (const PlacedError&) {  // the stage tells that itself
        return {};
    }
    std::vector<std::string> notes;
    const std::vector<std::string> timed = {"t", "duration"};
    for (std::size_t n = 0; n < spec.size(); ++n) {
        const Load& load = machine.apparatus.load[n];
        const bool is_nothing = load.force.empty()
                                    ? load.pressure == 0
                                    : std::all_of(load.force.begin(), load.force.end(),
                                                  [](const Vec3& f) { return f == Vec3::Zero(); });
        const auto is_read = [](const Expression& one) { return is_judged_as_read(one, {}); };
        const bool is_told = spec[n].force ? std::ranges::all_of(*spec[n].force, is_read)
                                           : is_read(spec[n].pressure);
        if (is_nothing && !is_told) {
            notes.push_back(fmt::format("{} does nothing: its {} is 0 at this work-piece",
                                        load_name(load.name),
                                        spec[n].force ? "force" : "pressure"));
        } else if (!is_nothing && most[n] == 0 && !is_judged_as_read(spec[n].strength, timed)) {
            notes.push_back(load_name(load.name) +
                            " does nothing: its strength is 0 throughout at this work-piece");
        }
    }
    const Expression& gravity = machine.spec.gravity_strength;
    if (machine.gravity_strength && most.back() == 0 && !is_judged_as_read(gravity, timed)) {
        notes.push_back("gravity does nothing: its strength is 0 throughout at this work-piece");
    }
    return notes;
}

}  // namespace

bool blade_stands(const Machine& machine, std::size_t n) {
    const std::vector<Pose> way = way_of(machine.blade_motion[n]);
    if (way.empty()) return false;
    const Blade& blade = machine.apparatus.blade[n];
    return std::ranges::all_of(blade.edge, [&](const Vec3& point) {
        const Vec3 at = machine.work_from_blade[n] * point, start = way.front() * at;
        return std::ranges::all_of(way, [&](const Pose& pose) { return pose * at == start; });
    });
}

std::vector<std::string> start_notes(const Machine& machine, const Aggregate& matter,
                                     const std::vector<Vec3>& touch, double spacing) {
    std::vector<std::string> notes;
    const auto note = [&](std::string sentence) {
        if (!sentence.empty()) notes.push_back(std::move(sentence));
    };
    const double slack = kOff * spacing;
    std::vector<Vec3> inner;
    if (!machine.apparatus.tool.empty()) inner = whole_middles(machine, matter);
    std::vector<std::vector<Pose>> tool_way;
    for (std::size_t n = 0; n < machine.apparatus.tool.size(); ++n) {
        const std::vector<Pose>& way = tool_way.emplace_back(way_of(machine.tool_motion[n]));
        note(depth_note(machine, n, touch, inner, way.empty() ? Pose{} : way.front(), slack));
        note(pivot_note(machine, n, machine.tool_motion[n].axis(), way, slack));
    }
    for (std::string& clash : tool_clashes(machine, tool_way, slack)) note(std::move(clash));
    const double reach = 0.5 * machine.frame.size.norm();
    const double jump = kJump * spacing;
    const auto of_jumps = [&](const std::string& kind, const auto& part,
                              const std::vector<Motion>& motion,
                              const std::vector<Pose>& work_from_part) {
        for (std::size_t n = 0; n < part.size(); ++n) {
            try {
                note(jump_note(kind + part[n].name, motion[n], way_of(motion[n]),
                               work_from_part[n].translation, reach, jump));
            } catch (const PlacedError&) {  // no value where it is looked at closely
            }
        }
    };
    const Apparatus& apparatus = machine.apparatus;
    for (std::size_t n = 0; n < apparatus.blade.size(); ++n) {
        if (!blade_stands(machine, n)) continue;
        note(fmt::format(
            "blade {} stands still: blades cut only by their own motion, and it will cut nothing",
            apparatus.blade[n].name));
    }
    for (std::size_t n = 0; only_blades_move(machine.spec) && n < apparatus.blade.size(); ++n) {
        note(miss_note(machine, n, way_of(machine.blade_motion[n]), spacing));
    }
    for (std::size_t n = 0; n < apparatus.grip.size(); ++n) {
        note(across_note(machine, n, way_of(machine.grip_motion[n]), slack));
    }
    for (const Load& load : apparatus.load) note(clamped_note(load, apparatus.grip));
    for (std::string& nothing : nothing_notes(machine)) note(std::move(nothing));
    of_jumps("tool ", apparatus.tool, machine.tool_motion, machine.work_from_tool);
    of_jumps("grip ", apparatus.grip, machine.grip_motion, machine.work_from_grip);
    of_jumps("blade ", apparatus.blade, machine.blade_motion, machine.work_from_blade);
    return notes;
}

}  // namespace swage
