// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth random functions of a place, the same on every machine. After K. Perlin, "Improving
// noise", 2002, with an integer hash instead of a table.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/math.h"

namespace swage {

inline std::uint32_t hash_of_cell(int i, int j, int k, std::uint32_t seed) {
    std::uint32_t h = seed * 0x9e3779b9u + static_cast<std::uint32_t>(i) * 0x85ebca6bu;
    h = (h ^ h >> 15) + static_cast<std::uint32_t>(j) * 0xc2b2ae35u;
    h = (h ^ h >> 13) * 0x27d4eb2fu + static_cast<std::uint32_t>(k) * 0x165667b1u;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

// About -1 to 1, zero on whole numbers, one swing or so a unit of length.
inline double gradient_noise(const Vec3& p, std::uint32_t seed) {
    const Vec3 base = p.array().floor();
    const Vec3 f = p - base;
    const Vec3 s =
        f.array() * f.array() * f.array() * (f.array() * (f.array() * 6.0 - 15.0) + 10.0);
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
        const int dx = c & 1, dy = c >> 1 & 1, dz = c >> 2;
        const std::uint32_t h =
            hash_of_cell(static_cast<int>(base.x()) + dx, static_cast<int>(base.y()) + dy,
                         static_cast<int>(base.z()) + dz, seed);
        const Vec3 slope = Vec3((h & 1023) / 511.5 - 1, (h >> 10 & 1023) / 511.5 - 1,
                                (h >> 20 & 1023) / 511.5 - 1);
        sum += (dx ? s.x() : 1 - s.x()) * (dy ? s.y() : 1 - s.y()) * (dz ? s.z() : 1 - s.z()) *
               slope.dot(f - Vec3(dx, dy, dz));
    }
    return 1.2 * sum;
}

// Sums octaves, each twice as fine and half as strong.
inline double layered_noise(const Vec3& p, int octaves, std::uint32_t seed) {
    double sum = 0, strength = 1, scale = 1;
    for (int o = 0; o < octaves; ++o, strength *= 0.5, scale *= 2)
        sum += strength * gradient_noise(scale * p, seed + o);
    return sum;
}

}  // namespace swage
