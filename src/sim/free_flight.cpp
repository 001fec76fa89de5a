// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/free_flight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/elasticity_of.h"
#include "sim/tool_entry.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr double kRoundings = 100;  // as much as one leaves, of many steps that add up

// What the body has surely left to go to a tool, whichever way [m].
double sure_gap(const Tool& tool, const Pose& world_from_tool, const Flyer& body) {
    const Pose tool_from_world = world_from_tool.inverse();
    const Box bounds = bounds_of(tool.shape);
    const Box close = bounds.widened(body.spacing);
    const SurfacePoints& points = body.touch->points();
    double least = std::numeric_limits<double>::infinity();
    const auto least_of = [&](std::size_t begin, std::size_t end) {
        double of_chunk = std::numeric_limits<double>::infinity();
        for (std::size_t p = begin; p < end; ++p) {
            if (!body.touch->meets(static_cast<int>(p))) continue;
            const Vec3 at = tool_from_world * points.position(p, *body.position);
            const double gap = close.contains(at)
                                   ? kSureShare * std::max(0.0, distance_to(tool.shape, at).value)
                                   : bounds.gap_to(at);
            of_chunk = std::min(of_chunk, gap);
        }
        return of_chunk;
    };
    for (double one : of_each_chunk(points.size(), least_of)) least = std::min(least, one);
    return least;
}

// The fastest that anything of a tool moves on its way [m/s]. Its corners may be farther from the
// world's origin on the way than at either end, but not than both together.
double top_speed(const Tool& tool, const Pose& from, const Pose& to, double time) {
    if (from.translation == to.translation && from.rotation.coeffs() == to.rotation.coeffs()) {
        return 0;
    }
    const Twist twist = twist_between(from, to);
    const Box bounds = bounds_of(tool.shape);
    double reach = 0;
    for (int c = 0; c < 8; ++c) {
        const Vec3 corner = bounds.corner(c);
        reach = std::max(reach, (from * corner).norm() + (to * corner).norm());
    }
    return (twist.shift.norm() + twist.turn.norm() * reach) / time;
}

// What goes this way takes at the least, beginning at this speed.
double time_for(double way, double speed, double acceleration) {
    if (!(way > 0)) return 0;
    const double end = std::sqrt(speed * speed + 2 * acceleration * way);
    return end > 0 ? 2 * way / (speed + end) : std::numeric_limits<double>::infinity();
}

}  // namespace

bool only_gravity_acts(const Apparatus& apparatus, const SimSettings& settings) {
    return settings.solver == Solver::explicit_steps && apparatus.grip.empty() &&
           apparatus.blade.empty() && apparatus.load.empty() && !medium_drags(settings);
}

double rounding_energy(const Aggregate& matter, double step) {
    const double moved = std::numeric_limits<double>::epsilon() / step;
    return chunked_sum(matter.particle_count(), [&](std::size_t p) {
        return matter.particle_mass[p] * moved * moved *
               matter.particle_position.at(p).squaredNorm();
    });
}

double elastic_rounding(const Aggregate& matter) {
    double modulus = 0;  // [J/kg]
    for (std::size_t n = 0; n < matter.material_count(); ++n) {
        if (elasticity_of(matter, n) == Elasticity::hencky) continue;
        const Material& material = matter.material_at(n);
        modulus = std::max(modulus, material.young_modulus / material.density);
    }
    return std::numeric_limits<double>::epsilon() * modulus * matter.mass();
}

bool holds_strain(const Aggregate& matter, double elastic, double step) {
    return !(elastic <= kRoundings * rounding_energy(matter, step) + elastic_rounding(matter));
}

std::optional<Vec3> flight_velocity(const Aggregate& matter, double step) {
    const Vec3Array& v = matter.particle_velocity;
    const Vec3 first = v.at(0);
    Vec3 momentum = Vec3::Zero();
    double mass = 0;
    for (std::size_t p = 0; p < v.size(); ++p) {
        momentum += matter.particle_mass[p] * (v.at(p) - first);
        mass += matter.particle_mass[p];
    }
    const Vec3 aside = momentum / mass;
    const double kinetic =
        0.5 * chunked_sum(v.size(), [&](std::size_t p) {
            return matter.particle_mass[p] * (v.at(p) - first - aside).squaredNorm();
        });
    if (!(kinetic <= kRoundings * rounding_energy(matter, step))) return std::nullopt;
    return first + aside;
}

double free_time(const std::vector<Flyer>& bodies, const Apparatus& apparatus, const Drive& from,
                 const Drive& to, const Drive& now, const Vec3& gravity) {
    double time = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < apparatus.tool.size(); ++t) {
        const Tool& tool = apparatus.tool[t];
        if (t < to.tool_way.size() && to.tool_way[t]) return 0;  // unevenly, and who knows how fast
        const double tool_speed =
            top_speed(tool, from.world_from_tool[t], to.world_from_tool[t], to.time - from.time);
        if (tool_speed > 0) time = std::min(time, to.time - now.time);
        for (const Flyer& body : bodies) {
            time = std::min(time, time_for(sure_gap(tool, now.world_from_tool[t], body),
                                           body.velocity.norm() + tool_speed, gravity.norm()));
        }
    }
    // They all fall alike, so that only their velocities bring them nearer to each other.
    std::vector<Box> box;
    for (const Flyer& body : bodies) box.push_back(box_of(*body.position));
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            const double speed = (bodies[a].velocity - bodies[b].velocity).norm();
            if (speed > 0) time = std::min(time, gap_between(box[a], box[b]) / speed);
        }
    }
    return time;
}

}  // namespace swage
