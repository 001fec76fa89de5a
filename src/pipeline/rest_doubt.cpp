// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rest_doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/text.h"
#include "base/units.h"
#include "pipeline/push_cone.h"
#include "pipeline/resting.h"
#include "pipeline/rounded_text.h"
#include "pipeline/slide_doubt.h"
#include "pipeline/touching_points.h"
#include "sim/load_set.h"

namespace swage {

namespace {

constexpr double kBears = 0.25;    // spacings by which it is not known where contacts bear
constexpr double kLeast = 1e-6;    // of a force: less is nothing
constexpr double kBalance = 1e-3;  // of what acts may be left
constexpr double kGrips = 1;       // friction of contacts, at the least: what slides does not lift
constexpr double kStiff = 0.1;     // rad, to which loads at most bend what tips as it is
constexpr std::size_t kContacts = 256;  // of a tool

std::vector<Wrench> pushes_of(const std::vector<Rest>& rests, const Vec3& centre, double radius) {
    std::vector<Wrench> all;
    for (const Rest& rest : rests) {
        const std::size_t every = 1 + rest.point.size() / kContacts;
        for (std::size_t n = 0; n < rest.point.size(); n += every) {
            const Vec3 normal = rest.out[n], one = normal.unitOrthogonal();
            const Vec3 other = normal.cross(one);
            for (const Vec3& aside : {one, Vec3(-one), other, Vec3(-other)}) {
                const Vec3 force = (normal + std::max(kGrips, rest.friction) * aside).normalized();
                const Vec3 arm = (rest.point[n] - centre) / radius;
                all.emplace_back();
                all.back() << force, arm.cross(force);
            }
        }
    }
    return all;
}

std::string force_text(double force) { return rounded_text(force, Quantity::force, 3); }

std::string tools_text(const Machine& machine) {
    std::vector<std::string> names;
    for (const Tool& tool : machine.apparatus.tool) names.push_back(tool.name);
    return joined(names, " and ");
}

std::string away_text(const StageSpec& stage, const Machine& machine, const Acting& worst) {
    if (stage.sim.gravity == Vec3::Zero()) {
        return "without gravity nothing presses the work-piece onto what it lies on, and its loads "
               "push it away";
    }
    const Vec3 up = -stage.sim.gravity.normalized();
    const std::string when =
        machine.gravity_strength
            ? fmt::format(" at {}", rounded_text(worst.time, Quantity::time, 3))
            : "";
    const double lift = up.dot(worst.loads);
    if (lift > worst.weight) {
        return fmt::format(
            "the loads lift the work-piece with {}{}{}, it weighs {}{}, and nothing holds it down",
            when.empty() ? "up to " : "", force_text(lift), when, force_text(worst.weight),
            when.empty() ? "" : " then");
    }
    return fmt::format("gravity{} presses the work-piece onto no tool: nothing holds it against {}",
                       worst.size > 0 ? ", with the loads," : "", tools_text(machine));
}

}  // namespace

std::string rest_doubt(const StageSpec& stage, const Machine& machine, const Aggregate& matter,
                       bool lies_as_told) {
    const std::vector<Vec3> body = touching_points(matter);
    if (machine.apparatus.tool.empty() || body.empty()) return {};
    const double a = matter.lattice.spacing;
    const Drive start = drive_at(machine, 0, stage.duration);
    std::vector<Rest> rests;
    bool are_apart = true, are_near = true;
    for (std::size_t n = 0; n < machine.apparatus.tool.size(); ++n) {
        rests.push_back(rest_on(machine.apparatus.tool[n], start.world_from_tool[n], body, a));
        are_apart = are_apart && rests.back().is_apart;
        are_near = are_near && rests.back().is_near;
    }
    const Box box = box_of(body);
    const Vec3 centre = matter.centre(), size = box.size();
    const double radius = 0.5 * size.norm();
    const std::vector<Wrench> pushes = pushes_of(rests, centre, radius);
    const auto is_borne = [&](const Vec3& force, const Vec3& torque) {
        Wrench wanted;
        wanted << -force, -torque / radius;
        return !left_over(pushes, wanted,
                          kBalance * wanted.norm() + kBears * a / radius * force.norm());
    };
    const LoadSet set(machine.apparatus, stage.sim);
    std::vector<Acting> away;
    bool tips = false;
    for (const Drive& now : looks_at(stage, machine)) {
        const Acting acts = acting(set, now, matter);
        const double least = kLeast * (acts.size + acts.weight);
        if (!(acts.force.norm() > least)) continue;
        const auto leaves = [&](const Rest& rest) { return acts.force.dot(rest.normal) > -least; };
        if (are_apart && std::all_of(rests.begin(), rests.end(), leaves)) {
            away.push_back(acts);
            continue;
        }
        const Vec3 weight = acts.force - acts.loads;
        const double length = size.maxCoeff(), height = size.minCoeff();
        const double bent = 6 * (acts.size + acts.weight) * length * length /
                            (matter.mean_modulus() * size.prod() / length * height * height);
        if (tips || !lies_as_told || !are_near || acts.size == 0 || bent > kStiff) continue;
        tips = is_borne(weight, Vec3::Zero()) && !is_borne(acts.force, acts.torque);
    }
    if (!away.empty()) {
        const auto lifted = [&](const Acting& one) {
            return -stage.sim.gravity.dot(one.loads) / std::max(1e-300, stage.sim.gravity.norm()) -
                   one.weight;
        };
        const Acting& worst = *std::max_element(
            away.begin(), away.end(),
            [&](const Acting& x, const Acting& y) { return lifted(x) < lifted(y); });
        return away_text(stage, machine, worst);
    }
    // What slides does not tip.
    const std::string slides = slide_doubt(stage, machine, matter, lies_as_told);
    if (!slides.empty() || !tips) return slides;
    return fmt::format("the loads tip the work-piece as it lies on {}, and {} holds it down",
                       tools_text(machine),
                       stage.sim.gravity == Vec3::Zero() ? "nothing" : "too little of its weight");
}

}  // namespace swage
