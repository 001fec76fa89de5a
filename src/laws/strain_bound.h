// SPDX-License-Identifier: GPL-3.0-or-later
// Which cells are far from their strength (laws/fracture.h), without a root or an eigenvalue:
//
//     g = |C - I|, M = sqrt(3 sum |Q_m|^2) / 4a      (laws/cell.h, at the cell's middle)
//     principal strain     <= sqrt(1 + g) - 1
//     connection's strain  <= sqrt(1 + g) - 1 + M    an edge is (D_x + s_y Q_xy + s_z Q_zx
//                                                    + s_y s_z Q_xyz) / 4, a diagonal has less
//
// so that no strain of the cell reaches e where g + 2 M < 2 e. Of the squares, (g + 2 M)^2 <=
// 5/4 (g^2 + 16 M^2): what is told apart is g^2 + 3 sum |Q_m|^2 / a^2 against 16/5 e^2. A bar that
// is pulled is told from 0.82 e on (nu = 0.3). Of matter that is not in the middle, but at (xi,
// eta, zeta) in the cell, F n has (eta n_x + xi n_y) Q_xy / 4a and so on more than in the middle;
// the four factors' squares add up to 7 at the most, in the corners: 7 takes the place of the 3.
#pragma once

#include "laws/cell.h"

namespace swage {

// Where a cell's matter is.
inline constexpr double kInMiddle = 3, kAnywhere = 7;

// `gram`: 1 / 16 a^2.
template <typename N>
SWAGE_INLINE N strain_measure(const CornerSums<N>& c, double gram, double matter) {
    const N xx = gram * dot(c.x, c.x) - 1.0, yy = gram * dot(c.y, c.y) - 1.0,
            zz = gram * dot(c.z, c.z) - 1.0;
    const N xy = gram * dot(c.x, c.y), yz = gram * dot(c.y, c.z), zx = gram * dot(c.z, c.x);
    const N modes = dot(c.xy, c.xy) + dot(c.yz, c.yz) + dot(c.zx, c.zx) + dot(c.xyz, c.xyz);
    return xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx) +
           (16 * matter * gram) * modes;
}

// No strain of a cell with less than this reaches `strain`; round-off included.
inline double strain_measure_at(double strain) { return 3.19 * strain * strain; }

}  // namespace swage
