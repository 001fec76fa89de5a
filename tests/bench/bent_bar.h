// SPDX-License-Identifier: GPL-3.0-or-later
// What benchmarks of forces and steps work on, and at which sizes.
#pragma once

#include <cmath>
#include <cstdlib>
#include <vector>

#include "tests/shared/block.h"

namespace swage::test {

// 2.4 : 1 : 1, slightly and smoothly out of shape.
inline Aggregate bent_bar(int cells_across, const Material& material) {
    Aggregate m = make_block(static_cast<int>(2.4 * cells_across), cells_across, cells_across, 0.01,
                             material);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p) / 0.01;
        const Vec3 u(std::sin(0.7 * x.y() + 0.3 * x.z()), std::cos(0.5 * x.x()),
                     std::sin(0.4 * x.y()));
        m.particle_position.add(p, 2e-5 * u);
    }
    return m;
}

// From the argument `first` on; 1e4 to 1e6 where none is given.
inline std::vector<double> given_sizes(int argc, char** argv, int first = 1) {
    std::vector<double> sizes;
    for (int n = first; n < argc; ++n) sizes.push_back(std::atof(argv[n]));
    return sizes.empty() ? std::vector<double>{1e4, 1e5, 1e6} : sizes;
}

}  // namespace swage::test
