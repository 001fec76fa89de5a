// SPDX-License-Identifier: GPL-3.0-or-later
// For tests that coarse matrices are the tangent seen through the coarse corners.
#pragma once

#include <random>

#include "sim/cell_tangent.h"
#include "sim/lattice_transfer.h"
#include "sim/node_stiffness.h"

namespace swage::test {

inline Vec3Array random_direction(std::size_t count) {
    std::mt19937 engine(11);
    std::uniform_real_distribution<double> draw(-1, 1);
    Vec3Array d;
    d.resize(count);
    for (auto* x : {&d.x, &d.y, &d.z}) {
        for (double& c : *x) c = draw(engine);
    }
    return d;
}

// Of the largest force along a random direction of the coarse corners.
inline double coarse_error(const Aggregate& matter, const Vec3i& ratio, TangentKind kind = {}) {
    CellTangent tangent(matter, matter.cell_fill);
    const Lattice coarse = coarse_lattice(matter.lattice, ratio);
    const LatticeTransfer transfer(matter.lattice, coarse, ratio);
    NodeStiffness matrix(coarse);
    matrix.add_cells(coarse, tangent.coarse_cells(matter, kind, coarse, ratio));
    const Vec3Array u = random_direction(particle_count(coarse));
    Vec3Array fine, product, back, got;
    fine.resize(matter.particle_count());
    for (auto* x : {&fine.x, &fine.y, &fine.z}) std::fill(x->begin(), x->end(), 0.0);
    transfer.add_prolonged(u, fine);
    tangent.product(matter, kind, fine, product);
    transfer.restricted(product, back);
    matrix.product(u, got);
    double largest = 0, off = 0;
    for (std::size_t p = 0; p < back.size(); ++p) {
        largest = std::max(largest, back.at(p).norm());
        off = std::max(off, (back.at(p) - got.at(p)).norm());
    }
    return off / largest;
}

}  // namespace swage::test
