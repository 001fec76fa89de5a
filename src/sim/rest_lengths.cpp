// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/rest_lengths.h"

#include <algorithm>
#include <cmath>

#include "base/portable_math.h"
#include "laws/cell_rest.h"
#include "sim/cell_volume.h"

namespace swage {

namespace {

constexpr double kLeastLength = 0.1;  // spacings: corners of slivers flow together

// Squared ratio of lengths along n.
double square_along(const Vec3& n, const Symmetric<double>& c) {
    const Triple<double> t = {n.x(), n.y(), n.z()};
    return dot(t, c * t);
}

Symmetric<double> metric_of(const MixedCell& mixed, int part) {
    CellHistory<double> history;
    for_each_number(history, [&](int n, double& to) { to = mixed.flowed[std::size_t(part)][n]; });
    return flowed_metric(history.stretch);
}

double mixed_ratio(const Aggregate& matter, const MixedCell& mixed,
                   const std::array<Symmetric<double>, 2>& metric, int direction) {
    const auto& f = kForward[direction];
    const Vec3 n = Vec3(f[0], f[1], f[2]).normalized();
    double fill = 0, give = 0, beside = 0, mean = 0, held = 0;
    for (int p : {0, 1}) {
        const double along = 0.5 * portable::log(square_along(n, metric[p]));
        const double share = mixed.fill[p];
        const double modulus = matter.material_at(mixed.material[p]).young_modulus;
        fill += share, give += share / modulus, beside += share * modulus;
        mean += share * along, held += share * modulus * along;
    }
    const double cosine = n.dot(mixed.normal.cast<double>()), square = cosine * cosine;
    const double series = square * fill * fill / give, parallel = 1 - square;
    return portable::exp((series * mean / fill + parallel * held) / (series + parallel * beside));
}

}  // namespace

SlotLengths rest_lengths(const Aggregate& matter, CellId cell, const MixedCell* mixed) {
    const double a = matter.lattice.spacing;
    std::array<double, kForwardCount> along;
    for (int d = 0; d < kForwardCount; ++d) along[d] = reference_length(matter.lattice, d);
    if (mixed) {
        const std::array<Symmetric<double>, 2> metric = {metric_of(*mixed, 0),
                                                         metric_of(*mixed, 1)};
        for (int d = 0; d < kForwardCount; ++d) along[d] *= mixed_ratio(matter, *mixed, metric, d);
    }
    SlotLengths lengths;
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        lengths[slot] = along[kCellConnection[slot].direction];
    }
    if (mixed || matter.cell_history.hardening_of(cell) == 0) return lengths;
    const CellRest<double> rest =
        cell_rest(committed_history(matter, cell), material_place(matter, cell), a);
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        const CellConnection& c = kCellConnection[slot];
        lengths[slot] =
            std::max(kLeastLength * a, std::sqrt(rest_square(rest, c.corner, upper_corner(c))));
    }
    return lengths;
}

}  // namespace swage
