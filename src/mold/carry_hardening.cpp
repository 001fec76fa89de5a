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

// Which of a cell's two it is; -1: neither.
int part_of(const MixedCell& mixed, std::size_t material) {
    return mixed.material[0] == material ? 0 : mixed.material[1] == material ? 1 : -1;
}

bool holds(const Aggregate& body, CellId cell, std::size_t material) {
    if (const MixedCell* mixed = body.mixed_at(cell)) return part_of(*mixed, material) >= 0;
    return body.material_number(cell) == material;
}

float hardening_of(const Aggregate& body, CellId cell, std::size_t material) {
    if (const MixedCell* mixed = body.mixed_at(cell)) {
        return mixed->flowed[static_cast<std::size_t>(part_of(*mixed, material))].back();
    }
    return body.cell_history.hardening_of(cell);
}

// Of each material what it had itself, there or as near as it was.
void carry_by_material(const Aggregate& from, Aggregate& to) {
    struct Part {
        std::size_t material;
        float* hardening;
    };
    std::vector<Vec3> place;
    std::vector<Part> part;
    to.cell_history.assign(to.cell_fill.size());
    const auto add = [&](CellId cell, const Eigen::Vector3f& centroid, std::size_t material,
                         float& hardening) {
        place.push_back(cell_middle(to, cell) + to.lattice.spacing * centroid.cast<double>());
        part.push_back({material, &hardening});
    };
    for (std::size_t c = 0; c < to.cell_fill.size(); ++c) {
        const auto cell = static_cast<CellId>(c);
        if (to.mixed_at(cell) != nullptr) continue;
        add(cell, to.cell_centroid[c], to.material_number(cell), to.cell_history.hardening()[c]);
    }
    for (MixedCell& mixed : to.mixed_cell) {
        for (const int m : {0, 1}) {
            add(mixed.cell, mixed.centroid[m], mixed.material[m], mixed.flowed[m].back());
        }
    }
    const std::vector<CellId> like = suited_cells_there(
        from, place,
        [&](std::size_t n, CellId cell) { return holds(from, cell, part[n].material); });
    for (std::size_t n = 0; n < part.size(); ++n) {
        if (like[n] >= 0) *part[n].hardening = hardening_of(from, like[n], part[n].material);
    }
}

}  // namespace

void carry_hardening(const Aggregate& from, Aggregate& to) {
    if (!from.has_flowed()) return;
    if (!from.inset.empty()) {
        carry_by_material(from, to);
        return;
    }
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
