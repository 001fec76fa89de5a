// SPDX-License-Identifier: GPL-3.0-or-later
// Slices one cell thick, of spacing 1 and Young's modulus 1, that cracks run through.
#pragma once

#include "matter/aggregate.h"
#include "verify/stand.h"

namespace swage {

inline constexpr double kCrackNu = 0.25, kCrackStrength = 1e-3;  // strength over E

// l_c = reach (laws/fracture.h).
Material breaking(double reach);
// Turned by an angle about z.
Aggregate slice(double length, double height, double angle, const Material& material);
// Severs what crosses the line from far left to `end`, a little above the middle so that it meets
// no particle.
void notch(Aggregate& matter, const Vec3& along, const Vec3& across, double end);

struct Tip {
    double ahead = -1e3;  // of the middle
    double off = 0;       // largest distance of a broken edge from the line
};
// Of the crack as far as `until` ahead of the middle.
Tip tip_of(const Aggregate& matter, const Vec3& along, const Vec3& across, double until = 1e3);

// Surface points farther out than `half` on one side (-1 or 1).
std::vector<int> clamped(const Aggregate& matter, const Vec3& across, int side, double half);
// By which the clamps of a strip of free height 2 half part when far ahead of the crack its energy
// is this share of what the crack asks: E / (1 - nu^2) opening^2 / (4 half) = share G_c.
double strip_opening(double share, double half, const Material& material);

}  // namespace swage
