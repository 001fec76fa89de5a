// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/connection_shares.h"

namespace swage {

double stiffness_in(const Aggregate& matter, CellId cell, const MixedCell* mixed, int direction,
                    const MaterialMask& counts) {
    const auto counted = [&](int m) { return counts.empty() || counts[m] != 0; };
    const auto modulus = [&](int m) {
        return matter.material_at(m).young_modulus / matter.material.young_modulus;
    };
    if (mixed == nullptr) {
        const int own = matter.cell_material.empty() ? 0 : matter.cell_material[cell];
        return counted(own) ? matter.cell_fill[cell] * modulus(own) : 0;
    }
    double fill = 0, give = 0, counted_give = 0, beside = 0;
    for (int p : {0, 1}) {
        const int m = mixed->material[p];
        const double f = mixed->fill[p], e = modulus(m);
        fill += f;
        give += f / e;
        if (!counted(m)) continue;
        counted_give += f / e;
        beside += f * e;
    }
    const auto& way = kForward[direction];
    const Vec3 along = Vec3(way[0], way[1], way[2]).normalized();
    const double cosine = along.dot(mixed->normal.cast<double>()), square = cosine * cosine;
    return square * (fill / give) * fill * (counted_give / give) + (1 - square) * beside;
}

ConnectionShares::ConnectionShares(const Aggregate& matter, const MaterialMask& counts) {
    if (matter.inset.empty()) return;
    for (std::vector<float>& of : share_) of.assign(matter.particle_count(), 0.0f);
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const CellId cell = run.first + n;
            const MixedCell* two = matter.mixed_at(cell);
            std::array<float, kForwardCount> own;
            for (int d = 0; d < kForwardCount; ++d) {
                const double share = cell_share(d);
                own[d] = static_cast<float>(share * stiffness_in(matter, cell, two, d, counts));
            }
            for (const auto& [direction, corner] : kCellConnection) {
                share_[direction][run.corner(n, corner)] += own[direction];
            }
        }
    }
}

void ConnectionShares::copy(const Aggregate& matter, int direction, ParticleId first, int count,
                            float* to) const {
    matter.connection[direction].weight.copy(first, count, to);
    if (share_[0].empty()) return;
    for (int n = 0; n < count; ++n) {
        if (to[n] > 0) to[n] = share_[direction][first + n];
    }
}

std::vector<DampedMaterials> damped_materials(const Aggregate& matter) {
    std::vector<DampedMaterials> groups;
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        const double ratio = matter.material_at(m).damping_ratio;
        if (!(ratio > 0)) continue;
        DampedMaterials* group = nullptr;
        for (DampedMaterials& g : groups) {
            if (g.damping_ratio == ratio) group = &g;
        }
        if (group == nullptr) {
            group = &groups.emplace_back(
                DampedMaterials{ratio, MaterialMask(matter.material_count(), 0)});
        }
        group->counts[m] = 1;
    }
    return groups;
}

}  // namespace swage
