// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "base/units.h"
#include "machines/machine.h"
#include "pipeline/rounded_text.h"
#include "pipeline/stage_machine.h"
#include "pipeline/touching_points.h"

namespace swage {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// When a body that flies by itself touches a standing plate [s].
double touches_after(const BoxShape& plate, const Pose& world_from_plate, const BodySpec& body,
                     const Aggregate& matter, const Vec3& gravity) {
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
    const double gap = low - half, speed = -up.dot(body.start.velocity), pull = -up.dot(gravity);
    if (gap <= 0) return 0;
    const double square = speed * speed + 2 * pull * gap;
    const double mean = square < 0 ? 0 : speed + std::sqrt(square);  // twice
    return mean > 0 ? 2 * gap / mean : kNever;
}

// Empty: it touches something in time, or that is not known.
std::string flight_doubt(const StageSpec& stage, const BodySpec& body, const Machine& machine,
                         const Aggregate& matter) {
    double soonest = kNever;
    std::vector<std::string> names;
    const Drive start = drive_at(machine, 0, stage.duration);
    for (std::size_t n = 0; n < machine.apparatus.tool.size(); ++n) {
        const Tool& tool = machine.apparatus.tool[n];
        const auto* plate = std::get_if<BoxShape>(&tool.shape);
        if (plate == nullptr || tool.finish != Finish::endless) return {};
        soonest = std::min(soonest, touches_after(*plate, start.world_from_tool[n], body, matter,
                                                  stage.sim.gravity));
        names.push_back(tool.name);
    }
    if (names.empty() || soonest <= stage.duration) return {};
    const std::string all = joined(names, " or ");
    if (soonest == kNever) {
        return fmt::format("{}: {} never touches {}: nothing brings it there", stage.name,
                           body.name, all);
    }
    return fmt::format("{}: {} {} for {:.3g} s before it touches {}, and the stage takes {:.3g} s",
                       stage.name, body.name, stage.sim.gravity == Vec3::Zero() ? "flies" : "falls",
                       soonest, all, stage.duration);
}

std::string force_text(double force) { return rounded_text(force, Quantity::force, 3); }

// Empty: its weight keeps it where it is, or something else may.
std::string lift_doubt(const StageSpec& stage, const Machine& machine, const Aggregate& matter) {
    constexpr int kLooks = 256;
    const double gravity = stage.sim.gravity.norm(), weight = gravity * matter.mass();
    const Vec3 up = gravity > 0 ? Vec3(-stage.sim.gravity / gravity)
                                : machine.frame.world_from_work.turn(Vec3::UnitY());
    double low = kNever;
    for (const Vec3& point : touching_points(matter)) low = std::min(low, up.dot(point));
    const Drive start = drive_at(machine, 0, 1);
    for (const Pose& tool : start.world_from_tool) {
        if (up.dot(tool.translation) >= low) return {};  // it may hold it down
    }
    std::vector<Vec3> push;
    for (const Load& load : machine.apparatus.load) {
        if (load.force.empty()) return {};
        Vec3& sum = push.emplace_back(Vec3::Zero());
        for (const Vec3& one : load.force) sum += one;
    }
    double most = 0;
    bool lifts = false;
    for (int n = 0; n <= kLooks; ++n) {
        const std::vector<double> strength = strengths_at(machine, double(n) / kLooks);
        Vec3 sum = Vec3::Zero();
        for (std::size_t l = 0; l < push.size(); ++l) sum += strength[l] * push[l];
        const double lift = up.dot(sum), least = 1e-6 * sum.norm();
        lifts = lifts || (weight > 0 ? lift > 1.0001 * strength.back() * weight + least
                                     : sum.norm() > 0 && lift > -least);
        most = std::max(most, lift);
    }
    if (!lifts) return {};
    if (weight == 0) {
        return fmt::format(
            "{}: without gravity nothing presses the work-piece onto what it lies on, and its "
            "loads push it away",
            stage.name);
    }
    return fmt::format(
        "{}: the loads lift the work-piece with up to {}, it weighs {}, and nothing holds it down",
        stage.name, force_text(most), force_text(weight));
}

}  // namespace

std::vector<std::string> doubts_of_start(const SceneSpec& scene,
                                         const std::vector<NamedMatter>& bodies) {
    if (bodies.size() != 1 || scene.stage.empty()) return {};
    const StageSpec& stage = scene.stage.front();
    const MachineSpec& spec = stage.machine;
    const bool flies =
        in_motion(stage.sim.solver) && spec.load.empty() && spec.gravity_strength.empty();
    const bool lies = !in_motion(stage.sim.solver) && !spec.load.empty() &&
                      (spec.upright || stage.sim.gravity != Vec3::Zero());
    if (!spec.stands() || !spec.grip.empty() || !spec.blade.empty() || !(flies || lies)) return {};
    const Aggregate& matter = *bodies.front().matter;
    std::string doubt;
    try {
        const Machine machine =
            stage_machine(stage, matter, {}, bodies.front().skin, bodies.front().coarser);
        doubt = flies ? flight_doubt(stage, scene.work_piece(), machine, matter)
                      : lift_doubt(stage, machine, matter);
    } catch (const Error&) {  // the stage tells that itself
    }
    return doubt.empty() ? std::vector<std::string>() : std::vector{doubt};
}

}  // namespace swage
