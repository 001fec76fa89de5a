// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/sleeping.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/internal_damping.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr double kTimes = 10;      // the slowest that it could do
constexpr double kWay = 1e-3;      // spacings
constexpr double kKinetic = 1e-6;  // of m g a

}  // namespace

Sleeping::Sleeping(const std::vector<Aggregate*>& bodies, const SimSettings& settings)
    : asleep_(bodies.size(), 0) {
    can_ = settings.sleep && settings.gravity.norm() > 0;
    if (!can_) return;
    for (const Aggregate* matter : bodies) {
        body_.push_back({.matter = matter,
                         .mass = matter->mass(),
                         .swing = 2 * std::numbers::pi / slowest_frequency(*matter),
                         .from = {}});
    }
}

bool Sleeping::rests(std::size_t body, double now, double kinetic, double gravity) {
    if (!can_) return false;
    Watched& at = body_[body];
    const double a = at.matter->lattice.spacing;
    if (!(gravity > 0 && kinetic < kKinetic * at.mass * gravity * a)) {
        at.lies = false;
        return false;
    }
    const double still = kTimes * std::max(std::sqrt(2 * a / gravity), at.swing);
    const Vec3Array& x = at.matter->particle_position;
    if (at.lies && farthest_move(at.from, x) <= kWay * a) return now - at.since >= still;
    at.lies = true;
    at.since = now;
    at.from = x;
    return false;
}

void Sleeping::wake(std::size_t body) {
    asleep_[body] = 0;
    if (can_) body_[body].lies = false;
}

}  // namespace swage
