// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "machines/machine.h"
#include "pipeline/parted_grips.h"
#include "pipeline/rest_doubt.h"
#include "pipeline/slide_doubt.h"
#include "pipeline/stage_machine.h"
#include "pipeline/start_overlap.h"
#include "pipeline/touching_points.h"
#include "sim/free_flight.h"

namespace swage {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-12;  // of a direction

// When a body that flies by itself touches a standing plate [s]; where a medium drags at it, no
// sooner than that.
double touches_after(const BoxShape& plate, const Pose& world_from_plate, const BodySpec& body,
                     const Aggregate& matter, const Vec3& gravity, bool drags) {
    int thin = 0;
    const double half = 0.5 * plate.size.minCoeff(&thin);
    const std::vector<Vec3> points = touching_points(matter);
    const Vec3 centre = matter.centre();
    Vec3 up = world_from_plate.turn(Vec3::Unit(thin));
    if (up.dot(centre - world_from_plate.translation) < 0) up = -up;
    double low = kNever, reach = 0;
    for (const Vec3& point : points) {
        low = std::min(low, up.dot(point - world_from_plate.translation));
        reach = std::max(reach, (point - centre).norm());
    }
    // What rotates may turn its farthest point down.
    if (body.start.spin != Vec3::Zero()) {
        low = up.dot(centre - world_from_plate.translation) - reach;
    }
    // Along a plate that stands straight but for rounding it does not come nearer.
    const auto towards = [&](const Vec3& way) {
        const double part = -up.dot(way);
        return std::abs(part) > kRounding * way.norm() ? part : 0;
    };
    const double gap = low - half, pull = towards(gravity);
    double speed = towards(body.start.velocity);
    if (drags && pull > 0) speed = std::max(0.0, speed);  // it stops what flies away, however soon
    if (gap <= 0) return 0;
    const double square = speed * speed + 2 * pull * gap;
    const double mean = square < 0 ? 0 : speed + std::sqrt(square);  // twice
    return mean > 0 ? 2 * gap / mean : kNever;
}

// Whether all of them fly alike, none of them in another: they do not meet.
bool fly_together(const SceneSpec& scene, const std::vector<NamedMatter>& bodies) {
    if (bodies.size() == 1) return true;
    const StartSpec& first = scene.work_piece().start;
    for (const BodySpec& body : scene.body) {
        if (body.start.velocity != first.velocity || body.start.spin != Vec3::Zero()) return false;
    }
    return start_overlaps(bodies).empty();
}

// What equilibria that follow make of a body that is still in flight then.
std::string motion_left_out(const SceneSpec& scene) {
    if (scene.stage.size() < 2 || in_motion(scene.stage[1].sim.solver)) return {};
    const StageSpec& stage = scene.stage.front();
    const StartSpec& start = scene.work_piece().start;
    const Vec3 velocity = start.velocity + stage.duration * stage.sim.gravity;
    if (velocity == Vec3::Zero() && start.spin == Vec3::Zero()) return {};
    return fmt::format("; {}, whose equilibria have no speed, leaves out that it still moves",
                       scene.stage[1].name);
}

// Empty: something touches a plate in time, or that is not known.
std::string flight_doubt(const SceneSpec& scene, const Machine& machine,
                         const std::vector<NamedMatter>& bodies) {
    const StageSpec& stage = scene.stage.front();
    const SimSettings& sim = stage.sim;
    const bool drags = medium_drags(sim);
    const bool aside = sim.directional_drag > 0 && sim.directional_drag_along == DragAlong::normal;
    if (aside || (drags && bodies.size() > 1) || !fly_together(scene, bodies)) return {};
    double soonest = kNever;
    std::size_t which = 0;
    std::vector<std::string> names;
    const Drive start = drive_at(machine, 0, stage.duration);
    for (std::size_t n = 0; n < machine.apparatus.tool.size(); ++n) {
        const Tool& tool = machine.apparatus.tool[n];
        const auto* plate = std::get_if<BoxShape>(&tool.shape);
        if (plate == nullptr || tool.finish != Finish::endless) return {};
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            const double after = touches_after(*plate, start.world_from_tool[n], scene.body[b],
                                               *bodies[b].matter, sim.gravity, drags);
            if (after < soonest) soonest = after, which = b;
        }
        names.push_back(tool.name);
    }
    if (names.empty() || soonest <= stage.duration) return {};
    const std::string all = joined(names, " or ");
    const std::string& name = scene.body[which].name;
    if (soonest == kNever) {
        return bodies.size() == 1
                   ? fmt::format("{}: {} never touches {}: nothing brings it there{}", stage.name,
                                 name, all, motion_left_out(scene))
                   : fmt::format("{}: no body ever touches {}: nothing brings any there",
                                 stage.name, all);
    }
    return fmt::format(
        "{}: {} {} for {}{:.3g} s before it touches {}, and the stage takes {:.3g} s{}", stage.name,
        name, sim.gravity == Vec3::Zero() ? "flies" : "falls", drags ? "more than " : "", soonest,
        all, stage.duration, motion_left_out(scene));
}

// Of the first stage: what a later one finds is told as that begins.
std::string parted_doubt(const SceneSpec& scene, const NamedMatter& work_piece) {
    const StageSpec& stage = scene.stage.front();
    // Coarser matter may part at a neck.
    if (stage.machine.grip.size() < 2 || work_piece.coarser > 1) return {};
    try {
        const std::string parted =
            parted_grips(stage, stage_machine(stage, *work_piece.matter, {}, work_piece.skin),
                         *work_piece.matter);
        return parted.empty() ? "" : stage.name + ": " + parted;
    } catch (const Error&) {  // the stage tells that itself
        return {};
    }
}

}  // namespace

std::vector<std::string> doubts_of_start(const SceneSpec& scene,
                                         const std::vector<NamedMatter>& bodies) {
    std::vector<std::string> doubts;
    const Aggregate& matter = *bodies.front().matter;
    if (std::string parted = parted_doubt(scene, bodies.front()); !parted.empty()) {
        doubts.push_back(std::move(parted));
    }
    for (const StageSpec& stage : scene.stage) {
        const MachineSpec& spec = stage.machine;
        const bool is_first = &stage == &scene.stage.front(), moves = in_motion(stage.sim.solver);
        const bool flies = is_first && moves && spec.load.empty() && spec.gravity_strength.empty();
        const bool lies = !moves && bodies.size() == 1;
        const bool is_held = !spec.grip.empty();
        if (spec.stands() && spec.blade.empty() && (lies || (flies && !is_held))) {
            std::string doubt;
            try {
                const Machine machine =
                    stage_machine(stage, matter, {}, bodies.front().skin, bodies.front().coarser);
                if (flies) {
                    doubt = flight_doubt(scene, machine, bodies);
                } else {
                    doubt = is_held ? slide_doubt(stage, machine, matter, is_first)
                                    : rest_doubt(stage, machine, matter, is_first);
                }
                if (lies && !doubt.empty()) doubt = stage.name + ": " + doubt;
            } catch (const Error&) {  // the stage tells that itself
            }
            if (!doubt.empty()) doubts.push_back(std::move(doubt));
        }
        // What was thrown or cut has another place or weight by now.
        if (moves || !spec.blade.empty() || scene.breaks()) break;
    }
    return doubts;
}

}  // namespace swage
