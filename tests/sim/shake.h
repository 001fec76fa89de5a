// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>

#include "matter/aggregate.h"

namespace swage::test {

// Moves each particle by up to so much along each axis [m].
inline void shake(Aggregate& matter, double by, int seed = 3) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> draw(-1, 1);
    Vec3Array& at = matter.particle_position;
    for (auto* x : {&at.x, &at.y, &at.z}) {
        for (double& v : *x) v += by * draw(engine);
    }
}

}  // namespace swage::test
