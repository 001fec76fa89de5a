// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/carry_hardening.h"

#include <cmath>

#include "base/portable_math.h"
#include "laws/cell_return.h"
#include "matter/cell_middle.h"
#include "mold/cells_there.h"

namespace swage {

namespace {

Mat3 middle_gradient(const Aggregate& m, CellId cell) {
    const std::array<ParticleId, 8> corner = m.lattice.cell_corners(cell);
    Mat3 gradient = Mat3::Zero();
    for (int c = 0; c < 8; ++c) {
        const Vec3 x = m.particle_position.at(corner[c]) / (4 * m.lattice.spacing);
        for (int d = 0; d < 3; ++d) gradient.col(d) += c >> d & 1 ? x : Vec3(-x);
    }
    return gradient;
}

// Six numbers of a cell: xx, yy, zz, xy, yz, zx.
template <std::size_t kCount>
Mat3 symmetric_in(const std::array<std::vector<float>, kCount>& row, CellId cell) {
    const auto at = [&](int n) { return double(row[n][cell]); };
    Mat3 m;
    m << at(0), at(3), at(5), at(3), at(1), at(4), at(5), at(4), at(2);
    return m;
}

// The mean back stress of each cell, turned as its matter is, along the axes of the new one. What
// is molded anew is without stress: no more of it than keeps that from flowing by itself.
void carry_back_stress(const Aggregate& from, const std::vector<CellId>& like, Aggregate& to) {
    if (from.cell_back.empty() || !to.material.shifts()) return;
    if (to.material.mechanics == Mechanics::springs) return;
    const Material& m = to.material;
    const CellModuli law = cell_moduli(m.young_modulus, m.poisson_ratio, to.lattice.spacing,
                                       m.yield_stress, m.hardening, m.flow_curve);
    to.cell_back.assign(like.size());
    for (std::size_t c = 0; c < like.size(); ++c) {
        const Mat3 flowed = Mat3::Identity() + symmetric_in(from.cell_history.row, like[c]);
        const Mat3 turn = nearest_rotation(middle_gradient(from, like[c]) * flowed);
        const Mat3 own = symmetric_in(from.cell_back.row, like[c]);
        Mat3 strain = turn * own * turn.transpose();
        const double gathered = to.cell_history.hardening()[c];
        const double radius = mean_flow_stress(law, gathered, 0) +
                              m.back_stress * portable::expm1(-gathered / m.back_strain);
        const double stress = std::sqrt(6.0) * law.shear * strain.norm();
        constexpr double kWithin = 0.999;
        if (stress > kWithin * radius) strain *= kWithin * radius / stress;
        constexpr int kPlace[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
        for (int n = 0; n < 6; ++n) {
            to.cell_back.row[n][c] = static_cast<float>(strain(kPlace[n][0], kPlace[n][1]));
        }
    }
}

}  // namespace

void carry_hardening(const Aggregate& from, Aggregate& to) {
    if (from.cell_history.empty()) return;
    const std::size_t count = to.cell_fill.size();
    std::vector<Vec3> place;
    for (std::size_t c = 0; c < count; ++c) {
        place.push_back(cell_middle(to, static_cast<CellId>(c)) +
                        to.lattice.spacing * to.cell_centroid[c].cast<double>());
    }
    const std::vector<CellId> like = cells_there(from, place);
    std::vector<float>& hardening = to.cell_history.hardening();
    if (to.material.mechanics == Mechanics::springs) {
        for (auto& slot : to.cell_plastic) slot.assign(count, 0.0f);
        hardening.resize(count);
    } else {
        to.cell_history.assign(count);
    }
    for (std::size_t c = 0; c < count; ++c) {
        hardening[c] = from.cell_history.hardening()[static_cast<std::size_t>(like[c])];
    }
    carry_back_stress(from, like, to);
}

}  // namespace swage
