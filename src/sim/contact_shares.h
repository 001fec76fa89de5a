// SPDX-License-Identifier: GPL-3.0-or-later
// What two ways of contact share that meet in the same place (sim/body_contact.h), from what either
// would hold alone.
#pragma once

#include <algorithm>
#include <cmath>

namespace swage {

// What springs would hold now if their way were alone, what those held that have ended since, and
// what those let go where the surface turned away from where points stick [J].
struct ContactHeld {
    using IsPlain = ContactHeld;
    double now = 0, gone = 0, turned = 0;
};

inline constexpr double kLeastOfBoth = 1e-3;  // of a way, so that its points keep a stiffness

// What of its own springs' doing a way has in that of both.
inline double share_of(double one, double other) {
    const double most = std::max(one, other);
    if (!(most > 0)) return 0.5;
    const auto square = [](double x) { return x * x; };
    const double part = one / most;
    const double mean =
        std::sqrt(std::sqrt(0.5 * (square(square(part)) + square(square(other / most)))));
    return (0.5 * part * square(part / mean) / mean + kLeastOfBoth) / (1 + 2 * kLeastOfBoth);
}

// What a way has at the most, where the other holds nothing.
inline double most_share() { return share_of(1, 0); }

inline double held_by_both(double one, double other) {
    return share_of(one, other) * one + share_of(other, one) * other;
}

// Of both ways together.
inline ContactHeld held_by_both(const ContactHeld& one, const ContactHeld& other) {
    const double ends = held_by_both(one.now, other.now),
                 turns = held_by_both(one.now + one.turned, other.now + other.turned),
                 begins = held_by_both(one.now + one.turned + one.gone,
                                       other.now + other.turned + other.gone);
    return {ends, begins - turns, turns - ends};
}

}  // namespace swage
