// SPDX-License-Identifier: GPL-3.0-or-later
// What contacts can bear is a cone: pushes along their normals and friction beside them. Whether it
// holds a force and torque is found by non-negative least squares (Lawson and Hanson, Solving Least
// Squares Problems, 1974).
#include "pipeline/rest_doubt.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <vector>

#include "base/text.h"
#include "base/units.h"
#include "pipeline/rounded_text.h"
#include "pipeline/touching_points.h"
#include "sim/load_set.h"

namespace swage {

namespace {

using Wrench = Eigen::Matrix<double, 6, 1>;  // [N], and torque over the body's radius

constexpr int kLooks = 64;         // at frames
constexpr double kLies = 0.05;     // spacings beside the nearest point: what lies on a tool, too
constexpr double kPlace = 0.5;     // spacings: the nearest point of what is not far
constexpr double kBears = 0.25;    // spacings by which it is not known where contacts bear
constexpr double kLeast = 1e-6;    // of a force: less is nothing
constexpr double kBalance = 1e-3;  // of what acts may be left
constexpr double kGrips = 1;       // friction of contacts, at the least: what slides does not lift
constexpr double kStiff = 0.1;     // rad, to which loads at most bend what tips as it is
constexpr std::size_t kContacts = 256;  // of a tool

// A tool as the body lies on it.
struct Rest {
    Vec3 normal = Vec3::Zero();  // of the tool, on the whole
    double friction = 0;
    bool is_apart = false;  // a plane across the normal parts it from the body
    bool is_near = false;
    std::vector<Vec3> point, out;  // contacts
};

Rest rest_on(const Tool& tool, const Pose& world_from_tool, const std::vector<Vec3>& body,
             double spacing) {
    Rest rest;
    rest.friction = std::max(kGrips, tool.friction);
    const Pose tool_from_world = world_from_tool.inverse();
    std::vector<Distance> all;
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& p : body) {
        all.push_back(distance_to(tool.shape, tool_from_world * p));
        least = std::min(least, all.back().value);
    }
    for (std::size_t p = 0; p < body.size(); ++p) {
        if (all[p].value > least + kLies * spacing) continue;
        rest.point.push_back(body[p]);
        rest.out.push_back(world_from_tool.turn(all[p].normal));
        rest.normal += rest.out.back();
    }
    if (!(rest.normal.norm() > 0)) return rest;
    rest.normal.normalize();
    rest.is_near = least < kPlace * spacing;
    double top = -std::numeric_limits<double>::infinity(), low = -top;
    for (const Vec3& p : surface_of(tool.shape).position) {
        top = std::max(top, rest.normal.dot(world_from_tool * p));
    }
    for (const Vec3& p : body) low = std::min(low, rest.normal.dot(p));
    rest.is_apart = low > top - kPlace * spacing;
    return rest;
}

// What acts on the body at one time: on the whole, about its centre.
struct Acting {
    double time = 0;  // [s]
    double weight = 0;
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  // of all
    Vec3 loads = Vec3::Zero();
    double size = 0;  // of loads, one by one [N]
};

Acting acting(const LoadSet& set, const Drive& now, const Aggregate& matter) {
    Acting acts;
    acts.time = now.time;
    const Vec3 centre = matter.centre();
    const std::vector<LoadSum> sums = set.sums(matter, now);
    for (std::size_t n = 0; n < sums.size(); ++n) {
        const bool is_weight = set.has_gravity() && n + 1 == sums.size();
        acts.force += sums[n].force;
        acts.torque += sums[n].torque + (sums[n].centre - centre).cross(sums[n].force);
        if (is_weight) {
            acts.weight = sums[n].force.norm();
        } else {
            acts.loads += sums[n].force;
            acts.size += sums[n].force.norm();
        }
    }
    return acts;
}

// Whether pushes, none of them less than nothing, come to this. True where that is not found.
bool come_to(const std::vector<Wrench>& push, const Wrench& wanted, double enough) {
    constexpr int kMostTurns = 200;
    constexpr double kGain = 1e-9;
    std::vector<std::size_t> used;
    Eigen::VectorXd share;
    Wrench left = wanted;
    for (int turn = 0; turn < kMostTurns; ++turn) {
        if (left.norm() <= enough) return true;
        std::size_t best = push.size();
        double most = kGain * wanted.norm();
        for (std::size_t n = 0; n < push.size(); ++n) {
            const double gain = push[n].dot(left);
            if (gain > most) most = gain, best = n;
        }
        if (best == push.size()) return false;
        if (std::ranges::find(used, best) != used.end()) return false;  // it comes to no more
        used.push_back(best);
        share.conservativeResize(Eigen::Index(used.size()));
        share[share.size() - 1] = 0;
        while (!used.empty()) {
            Eigen::MatrixXd columns(6, Eigen::Index(used.size()));
            for (std::size_t n = 0; n < used.size(); ++n) {
                columns.col(Eigen::Index(n)) = push[used[n]];
            }
            const Eigen::VectorXd next = columns.colPivHouseholderQr().solve(wanted);
            left = wanted - columns * next;
            if (next.minCoeff() > 0) {
                share = next;
                break;
            }
            double far = 1;
            for (Eigen::Index n = 0; n < next.size(); ++n) {
                if (next[n] <= 0) far = std::min(far, share[n] / (share[n] - next[n]));
            }
            share += far * (next - share);
            const double none = kGain * share.maxCoeff();
            std::vector<std::size_t> kept;
            std::vector<double> of;
            for (std::size_t n = 0; n < used.size(); ++n) {
                const Eigen::Index i = Eigen::Index(n);
                if (next[i] <= 0 && share[i] <= none) continue;
                kept.push_back(used[n]);
                of.push_back(share[i]);
            }
            used = kept;
            share = Eigen::Map<Eigen::VectorXd>(of.data(), Eigen::Index(of.size()));
        }
        if (used.empty()) left = wanted;
    }
    return true;
}

std::vector<Wrench> pushes_of(const std::vector<Rest>& rests, const Vec3& centre, double radius) {
    std::vector<Wrench> all;
    for (const Rest& rest : rests) {
        const std::size_t every = 1 + rest.point.size() / kContacts;
        for (std::size_t n = 0; n < rest.point.size(); n += every) {
            const Vec3 normal = rest.out[n], one = normal.unitOrthogonal();
            const Vec3 other = normal.cross(one);
            for (const Vec3& aside : {one, Vec3(-one), other, Vec3(-other)}) {
                const Vec3 force = (normal + rest.friction * aside).normalized();
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
        return come_to(pushes, wanted,
                       kBalance * wanted.norm() + kBears * a / radius * force.norm());
    };
    const LoadSet set(machine.apparatus, stage.sim);
    const int looks = std::min(stage.frames, kLooks);
    std::vector<Acting> away;
    bool tips = false;
    for (int n = 1; n <= looks; ++n) {
        const int frame = static_cast<int>(long(stage.frames) * n / looks);
        const Acting acts =
            acting(set, drive_at(machine, double(frame) / stage.frames, stage.duration), matter);
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
    if (!tips) return {};
    return fmt::format("the loads tip the work-piece as it lies on {}, and {} holds it down",
                       tools_text(machine),
                       stage.sim.gravity == Vec3::Zero() ? "nothing" : "too little of its weight");
}

}  // namespace swage
