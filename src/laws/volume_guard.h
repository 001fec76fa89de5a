// SPDX-License-Identifier: GPL-3.0-or-later
// What crushed cells resist with. Neither springs nor a strain of C = F^T F know inside from
// outside: a mirrored cell is as content as the cell, and the push against being crushed fades on
// the way there; rubber's law rests at a point too, and foam's. Below half of its volume, and foam
// below where its law goes straight on, a cell therefore also resists by its volume and by a strain
// that goes on where the law's turns back:
//
//     W = E (V - J)^2 / 2 + b(J) [H(g(s)) - W_law]           per volume at molding [J/m3]
//     H(e) = mu |dev e|^2 + K (tr e)^2 / 2        b = (1 - J/V)^2 (1 + 2 J/V), 1 where J < 0
//     g(s) = e(s), the strain of laws/cell.h, y + y^3/3 + y^5/5, y = (s^2 - 1)/(s^2 + 1);
//            below s_t = 1/3, where e is steepest,
//            e(s_t) - e'(s_t) d / (1 + d/L), d = s_t - s, L = 1/2    rising for every s
//
// V = 1/2, or less for foam, J = det F, s the principal stretches: of F_e where a cell has flowed.
// Where J < 0 each of the three may be the one that is turned: H(g) is the mean of the three,
// weighed by 1/s_i^2, which next to J = 0 leaves the smallest (taken alone, as by Irving, Teran,
// Fedkiw, "Invertible finite elements", SCA 2004, the force would jump where two are equal). Cells
// of the cell law give up what their own law says, W_law, by the share b, for H(g) + K g(J)^2 / 2,
// and so rest in one shape alone. Springs, rubber and foam keep theirs, for which W_law stands for
// 0.
//
// Nothing above that volume feels any of this: it changes no answer that can be trusted.
//
// NOTE: a larger L gives more back than matter can take without being torn; with a smaller one g
// turns too flat to win over what nearly incompressible matter has besides.
#pragma once

#include <Eigen/SVD>

#include "base/math.h"

namespace swage {

inline constexpr double kGuardedVolume = 0.5;
inline constexpr double kSteepest = 1.0 / 3;  // s_t
inline constexpr double kFlattens = 0.5;      // L

struct GuardModuli {
    double young, shear, bulk;       // E, mu, K [Pa]
    bool fades;                      // the cell's own law
    double volume = kGuardedVolume;  // V
};

struct GuardedCell {
    double energy;     // W without W_law [J/m3]
    Mat3 stress;       // its dW/dF [Pa]
    double share;      // b
    Mat3 share_slope;  // db/dF
};

// e and de/ds at one stretch.
struct StretchStrain {
    double value, slope;
};
inline StretchStrain cell_law_strain(double s) {
    const double over = 1 / (s * s + 1), y = (s * s - 1) * over, y2 = y * y;
    return {y * (1 + y2 / 3 + y2 * y2 / 5), 4 * s * over * over * (1 + y2 + y2 * y2)};
}
inline StretchStrain guarded_strain(double s) {
    if (s >= kSteepest) return cell_law_strain(s);
    const StretchStrain at = cell_law_strain(kSteepest);
    const double below = kSteepest - s, part = 1 / (1 + below / kFlattens);
    return {at.value - at.slope * below * part, at.slope * part * part};
}

inline double hencky_energy(const GuardModuli& law, const Vec3& e) {
    const double size = e.sum();
    return law.shear * (e.squaredNorm() - size * size / 3) + 0.5 * law.bulk * size * size;
}
inline Vec3 hencky_stress(const GuardModuli& law, const Vec3& e) {
    const double size = e.sum();
    return 2 * law.shear * e + Vec3::Constant((law.bulk - 2.0 / 3 * law.shear) * size);
}

// H(g) of a cell with stretches s, and its slope with each.
struct CellResistance {
    double energy;
    Vec3 slope;
};
inline CellResistance resistance_of(const GuardModuli& law, const Vec3& s) {
    Vec3 g, slope;
    for (int i = 0; i < 3; ++i) {
        const StretchStrain strain = guarded_strain(s[i]);
        g[i] = strain.value, slope[i] = strain.slope;
    }
    return {hencky_energy(law, g), hencky_stress(law, g).cwiseProduct(slope)};
}
// Of a cell that is inside out; x are its stretches without signs.
inline CellResistance inverted_resistance(const GuardModuli& law, const Vec3& x) {
    const Vec3 square = x.cwiseAbs2();
    const Vec3 share(square[1] * square[2], square[2] * square[0], square[0] * square[1]);
    const double whole = share.sum();
    if (!(whole > 0)) return resistance_of(law, {x[0], x[1], -x[2]});
    CellResistance sum{0, Vec3::Zero()};
    Vec3 turned_energy;
    for (int i = 0; i < 3; ++i) {
        Vec3 s = x;
        s[i] = -s[i];
        CellResistance turned = resistance_of(law, s);
        turned.slope[i] = -turned.slope[i];
        const double weight = share[i] / whole;
        turned_energy[i] = turned.energy;
        sum.energy += weight * turned.energy;
        sum.slope += weight * turned.slope;
    }
    for (int k = 0; k < 3; ++k) {  // the shares change too
        for (int i = 0; i < 3; ++i) {
            if (i == k) continue;
            sum.slope[k] += 2 * x[k] * square[3 - i - k] / whole * (turned_energy[i] - sum.energy);
        }
    }
    return sum;
}

// Zero above V.
inline GuardedCell guard_cell(const GuardModuli& law, const Mat3& gradient) {
    const double volume = gradient.determinant(), whole = law.volume, lost = whole - volume;
    if (!(lost > 0)) return {0, Mat3::Zero(), 0, Mat3::Zero()};
    const Eigen::JacobiSVD<Mat3> split(gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Vec3 x = split.singularValues();
    const bool inverted = volume < 0;
    const CellResistance asked = inverted ? inverted_resistance(law, x) : resistance_of(law, x);
    const StretchStrain size = guarded_strain(volume);
    const double square = whole * whole;
    const double share = inverted ? 1 : 1 / square * lost * lost * (1 + 2 / whole * volume);
    const double share_slope = inverted ? 0 : -6 / (square * whole) * volume * lost;
    const Vec3 area = (inverted ? -1 : 1) * Vec3(x[1] * x[2], x[2] * x[0], x[0] * x[1]);  // dJ/dx
    const double bulk = law.fades ? law.bulk : 0;
    const double resisted = asked.energy + 0.5 * bulk * size.value * size.value;
    const Vec3 push =
        share * asked.slope +
        (share * bulk * size.value * size.slope + share_slope * resisted - law.young * lost) * area;
    const auto along = [&](const Vec3& v) -> Mat3 {
        return split.matrixU() * v.asDiagonal() * split.matrixV().transpose();
    };
    return {0.5 * law.young * lost * lost + share * resisted, along(push), share,
            along(share_slope * area)};
}

// The most that d2W/ds2 comes to in a cell that is inside out, about [Pa].
inline double guard_stiffness(const GuardModuli& law) {
    const double slope = guarded_strain(kSteepest).slope;
    return 2 * (law.bulk + 4.0 / 3 * law.shear) * slope * slope;
}

}  // namespace swage
