// SPDX-License-Identifier: GPL-3.0-or-later
// What takes back the stretch that a cell has flowed: A of laws/cell.h, from where it is kept.
#pragma once

#include "base/math.h"
#include "matter/aggregate.h"

namespace swage {

// `kept`: xx, yy, zz, xy, yz, zx of A - I.
template <typename Kept>
Mat3 flowed_stretch(const Kept& kept) {
    Mat3 a;
    a << 1 + kept(0), kept(3), kept(5), kept(3), 1 + kept(1), kept(4), kept(5), kept(4),
        1 + kept(2);
    return a;
}

// Of a cell of one material.
inline Mat3 flowed_stretch(const Aggregate& matter, CellId cell) {
    const auto& kept = matter.cell_history.row;
    if (kept[0].empty()) return Mat3::Identity();
    return flowed_stretch([&](int n) { return double(kept[n][cell]); });
}

// At least by how much a cell is stiffer for being thinner: the greatest eigenvalue of A^2.
inline double thinned(const Mat3& a) {
    const double most = a.cwiseAbs().rowwise().sum().maxCoeff();
    return most * most;
}

}  // namespace swage
