// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/carry_hardening.h"

#include <cmath>

#include "base/portable_math.h"
#include "laws/cell_return.h"
#include "matter/cell_middle.h"
#include "mold/cells_there.h"
#include "mold/shared_matter.h"

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

// Bodies of several materials have none.
bool has_back_stress(const Aggregate& from, const Aggregate& to) {
    return !from.cell_back.empty() && to.inset.empty() && to.material.shifts() &&
           to.material.mechanics != Mechanics::springs;
}

// A cell's mean back stress, turned as its matter is.
Mat3 turned_back(const Aggregate& from, CellId cell) {
    const Mat3 flowed = Mat3::Identity() + symmetric_in(from.cell_history.row, cell);
    const Mat3 turn = nearest_rotation(middle_gradient(from, cell) * flowed);
    return turn * symmetric_in(from.cell_back.row, cell) * turn.transpose();
}

// Along the axes of the new cells. What is molded anew is without stress: no more of it than keeps
// that from flowing by itself.
void lay_back_stress(const std::vector<Mat3>& back, Aggregate& to) {
    const Material& m = to.material;
    const CellModuli law = cell_moduli(m.young_modulus, m.poisson_ratio, to.lattice.spacing,
                                       m.yield_stress, m.hardening, m.flow_curve);
    to.cell_back.assign(back.size());
    for (std::size_t c = 0; c < back.size(); ++c) {
        Mat3 strain = back[c];
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

// Of each new part what the old ones have that share it.
struct Carried {
    std::vector<double> hardening;
    std::vector<Mat3> back;  // empty where there is none
};

// Where no old part reaches: as the nearest of its material.
void fill_gaps(const Aggregate& from, const Aggregate& to, const std::vector<MatterPart>& part,
               const std::vector<double>& share, Carried& carried) {
    std::vector<std::size_t> gap;
    std::vector<Vec3> place;
    for (std::size_t n = 0; n < part.size(); ++n) {
        if (share[n] > 0) continue;
        gap.push_back(n);
        place.push_back(cell_middle(to, part[n].cell) + to.lattice.spacing * part[n].centroid);
    }
    if (gap.empty()) return;
    const std::vector<CellId> like = suited_cells_there(
        from, place,
        [&](std::size_t n, CellId cell) { return holds(from, cell, part[gap[n]].material); });
    for (std::size_t n = 0; n < gap.size(); ++n) {
        if (like[n] < 0) continue;
        carried.hardening[gap[n]] = hardening_of(from, like[n], part[gap[n]].material);
        if (!carried.back.empty()) carried.back[gap[n]] = turned_back(from, like[n]);
    }
}

// Of each material hardening times mass, as its mean: what is molded anew may have another volume.
// Of what has no cell any more nothing is left.
void keep_means(const Aggregate& from, const std::vector<MatterPart>& old,
                const std::vector<MatterPart>& part, std::vector<double>& hardening) {
    struct Sum {
        double volume = 0, hardening = 0;
        double mean() const { return volume > 0 ? hardening / volume : 0; }
    };
    std::vector<Sum> had(from.material_count()), has(from.material_count());
    const auto add = [](double volume, double gathered, Sum& sum) {
        sum.volume += volume, sum.hardening += volume * gathered;
    };
    for (const MatterPart& one : old) {
        add(one.volume, hardening_of(from, one.cell, one.material), had[one.material]);
    }
    for (std::size_t n = 0; n < part.size(); ++n) {
        add(part[n].volume, hardening[n], has[part[n].material]);
    }
    for (std::size_t n = 0; n < part.size(); ++n) {
        const std::size_t m = part[n].material;
        const double mean = had[m].mean(), found = has[m].mean();
        hardening[n] = found > 0 ? hardening[n] * (mean / found) : mean;
    }
}

Carried carried_to(const Aggregate& from, const Aggregate& to,
                   const std::vector<MatterPart>& part) {
    const std::vector<MatterPart> old = matter_parts(from);
    std::vector<double> share(part.size(), 0.0);
    Carried carried;
    carried.hardening.assign(part.size(), 0.0);
    if (has_back_stress(from, to)) carried.back.assign(part.size(), Mat3::Zero());
    int latest = -1;
    double hardening = 0;
    Mat3 back = Mat3::Zero();
    for_each_shared(from, old, to, part, [&](const SharedMatter& one) {
        if (one.from != latest) {
            latest = one.from;
            const MatterPart& own = old[one.from];
            hardening = hardening_of(from, own.cell, own.material);
            if (!carried.back.empty()) back = turned_back(from, own.cell);
        }
        share[one.to] += one.volume;
        carried.hardening[one.to] += one.volume * hardening;
        if (!carried.back.empty()) carried.back[one.to] += one.volume * back;
    });
    for (std::size_t n = 0; n < part.size(); ++n) {
        if (!(share[n] > 0)) continue;
        carried.hardening[n] /= share[n];
        if (!carried.back.empty()) carried.back[n] /= share[n];
    }
    fill_gaps(from, to, part, share, carried);
    keep_means(from, old, part, carried.hardening);
    return carried;
}

}  // namespace

void carry_hardening(const Aggregate& from, Aggregate& to) {
    if (!from.has_flowed()) return;
    const std::vector<MatterPart> part = matter_parts(to);
    const Carried carried = carried_to(from, to, part);
    const std::size_t count = to.cell_fill.size();
    if (to.material.mechanics == Mechanics::springs) {
        for (auto& slot : to.cell_plastic) slot.assign(count, 0.0f);
        to.cell_history.hardening().resize(count);
    } else {
        to.cell_history.assign(count);
    }
    auto mixed = to.mixed_cell.begin();
    for (std::size_t n = 0; n < part.size(); ++n) {
        const auto hardening = static_cast<float>(carried.hardening[n]);
        if (part[n].mixed < 0) {
            to.cell_history.hardening()[part[n].cell] = hardening;
            continue;
        }
        mixed->flowed[part[n].mixed].back() = hardening;
        if (part[n].mixed == 1) ++mixed;
    }
    if (!carried.back.empty()) lay_back_stress(carried.back, to);
}

}  // namespace swage
