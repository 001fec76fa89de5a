// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/slide_doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "base/units.h"
#include "base/way_text.h"
#include "pipeline/push_cone.h"
#include "pipeline/resting.h"
#include "pipeline/rounded_text.h"
#include "pipeline/touching_points.h"
#include "sim/free_pieces.h"

namespace swage {

namespace {

constexpr double kSlides = 0.1;        // of what acts: less is not sure
constexpr std::size_t kContacts = 64;  // of a tool
constexpr const char* kInstead =
    "equilibria cannot move: hold it, or let it move with solver = \"explicit\"";

std::string pushers(const StageSpec& stage, const Machine& machine) {
    if (machine.apparatus.load.empty()) return "gravity pulls";
    return stage.sim.gravity == Vec3::Zero() ? "the loads push" : "loads and gravity push";
}

std::string force_text(double force) { return rounded_text(force, Quantity::force, 3); }

// Where no tool is in its way.
std::string free_doubt(const StageSpec& stage, const Machine& machine, const Aggregate& matter) {
    const LoadSet set(machine.apparatus, stage.sim);
    FreePieces pieces(matter, machine.apparatus);
    if (pieces.are_several()) return {};  // some of them may be left alone
    Vec3 push = Vec3::Zero(), turn = Vec3::Zero();
    for (const Drive& now : looks_at(stage, machine)) {
        if (pieces.is_pushed_off(set, now)) {
            const Vec3 off = pieces.push_off(set, now);
            if (off.norm() > push.norm()) push = off;
        } else if (turn.isZero(0)) {
            turn = pieces.turn_off(set, now);
        }
    }
    if (!push.isZero(0)) {
        return fmt::format(
            "{} the work-piece with up to {} along the world's {}, which its grips leave free, and "
            "{}",
            pushers(stage, machine), force_text(push.norm()), way_text(push.normalized()),
            kInstead);
    }
    if (turn.isZero(0)) return {};
    return fmt::format(
        "{} the work-piece round the world's {}, and its grips leave it free to turn so: it comes "
        "to rest where it has turned, or nowhere",
        pushers(stage, machine), way_text(turn.normalized()));
}

// What tools and grips can bear. NOTE: friction is taken along four sides of a square round its
// circle, so too large.
enum class Friction { none, much };
std::vector<Wrench> bearing(const Machine& machine, const std::vector<Vec3>& body, double spacing,
                            const Drive& start, Friction friction) {
    const double share = friction == Friction::much ? std::sqrt(2.0) : 0;
    std::vector<Wrench> all;
    const auto add = [&](const Vec3& force) {
        all.emplace_back(Wrench::Zero());
        all.back().head<3>() = force.normalized();
    };
    for (std::size_t n = 0; n < machine.apparatus.tool.size(); ++n) {
        const Rest rest =
            rest_on(machine.apparatus.tool[n], start.world_from_tool[n], body, spacing);
        const std::size_t every = 1 + rest.out.size() / kContacts;
        for (std::size_t p = 0; p < rest.out.size(); p += every) {
            const Vec3 normal = rest.out[p], one = normal.unitOrthogonal();
            const Vec3 other = normal.cross(one);
            for (const Vec3& aside : {one, Vec3(-one), other, Vec3(-other)}) {
                add(normal + share * rest.friction * aside);
            }
        }
    }
    for (std::size_t g = 0; g < machine.apparatus.grip.size(); ++g) {
        for (int axis = 0; axis < 3; ++axis) {
            if (machine.apparatus.grip[g].hold[axis] == 0) continue;
            const Vec3 held = start.world_from_grip[g].turn(Vec3::Unit(axis));
            add(held), add(-held);
        }
    }
    return all;
}

std::string tool_doubt(const StageSpec& stage, const Machine& machine, const Aggregate& matter) {
    const std::vector<Vec3> body = touching_points(matter);
    if (body.empty()) return {};
    const LoadSet set(machine.apparatus, stage.sim);
    const Drive start = drive_at(machine, 0, stage.duration);
    const double a = matter.lattice.spacing;
    const std::vector<Wrench> borne = bearing(machine, body, a, start, Friction::much),
                              smooth = bearing(machine, body, a, start, Friction::none);
    Vec3 most = Vec3::Zero();
    for (const Drive& now : looks_at(stage, machine)) {
        const Acting acts = acting(set, now, matter);
        Wrench wanted = Wrench::Zero();
        wanted.head<3>() = -acts.force;
        const double sure = kSlides * (acts.size + acts.weight);
        if (!left_over(borne, wanted, sure)) continue;
        // What friction leaves of it goes where all of it would go without.
        const auto left = left_over(smooth, wanted, sure);
        if (left && left->norm() > most.norm()) most = -left->head<3>();
    }
    if (most.isZero(0)) return {};
    std::vector<std::string> names;
    for (const Tool& tool : machine.apparatus.tool) names.push_back(tool.name);
    for (const Grip& grip : machine.apparatus.grip) names.push_back(grip.name);
    return fmt::format("{} the work-piece along the world's {} by more than {} there, and {}",
                       pushers(stage, machine), way_text(most.normalized()),
                       joined(names, " and ") + (names.size() == 1 ? " bears" : " bear"), kInstead);
}

}  // namespace

std::string slide_doubt(const StageSpec& stage, const Machine& machine, const Aggregate& matter,
                        bool lies_as_told) {
    const Apparatus& apparatus = machine.apparatus;
    const auto is_firm = [](const Grip& grip) { return grip.hold == Vec3::Ones(); };
    if (std::ranges::any_of(apparatus.grip, is_firm)) return {};
    const auto is_hollow =
        [](const Tool& tool) {  // perhaps: it may stop what it does not touch yet
            return std::holds_alternative<MeshShape>(tool.shape);
        };
    if (std::ranges::any_of(apparatus.tool, is_hollow)) return {};
    if (!apparatus.tool.empty()) return lies_as_told ? tool_doubt(stage, machine, matter) : "";
    return apparatus.grip.empty() ? "" : free_doubt(stage, machine, matter);
}

}  // namespace swage
