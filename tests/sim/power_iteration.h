// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>

#include "sim/lattice_forces.h"

namespace swage::test {

// The largest eigenvalue of B^-1 K from below, K the forces' slope as the matter is, B a diagonal.
inline double largest_value(Aggregate matter, const std::vector<double>& b, int rounds) {
    LatticeForces forces(matter);
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> draw(-1, 1);
    std::vector<Vec3> u(matter.particle_count());
    for (Vec3& v : u) v = Vec3(draw(engine), draw(engine), draw(engine));
    const Vec3Array rest = matter.particle_position;
    const double nudge = 1e-7 * matter.lattice.spacing * std::sqrt(b[0]);
    double value = 0;
    for (int n = 0; n < rounds; ++n) {
        double norm = 0;
        for (std::size_t p = 0; p < u.size(); ++p) norm += b[p] * u[p].squaredNorm();
        for (std::size_t p = 0; p < u.size(); ++p) {
            u[p] /= std::sqrt(norm);
            matter.particle_position.set(p, rest.at(p) + nudge * u[p]);
        }
        Vec3Array f;
        forces.find(matter, Flow::trial, f);
        value = 0;
        for (std::size_t p = 0; p < u.size(); ++p) {
            const Vec3 ku = -f.at(p) / nudge;
            value += u[p].dot(ku);
            u[p] = ku / b[p];
        }
    }
    return value;
}

}  // namespace swage::test
