// SPDX-License-Identifier: GPL-3.0-or-later
// A cell of eight particles as matter: the mean of its connections' strains carries Hooke's law for
// any Poisson's ratio, their deviations carry bending and twist.
//
//     F = grad x at the centroid of the cell's material      C = F^T F
//     Y = (C - I)(C + I)^-1                                  Cayley strain, tanh(ln U)
//     E = Y + Y^3/3 + Y^5/5                                  ln U but for |E|^7/7
//     Q_m = sum of h_m x over the corners [m]                m = xy, yz, zx, xyz; h_xy = s_x s_y,
//     ...; q_m = F^T Q_m                                          s = -1, +1 at the two ends of an
//     axis
//
//     W = f V [mu |dev E|^2 + K (tr E)^2 / 2] + f^3 W_q      [J]
//     W_q = c_e/2 [xy_x^2 + xy_y^2 + yz_y^2 + yz_z^2 + zx_z^2 + zx_x^2 + |xyz|^2]
//         + c_d/2 [(yz_y + zx_x)^2 + (yz_z + xy_x)^2 + (zx_z + xy_y)^2
//                + (yz_x + zx_y)^2 + (zx_y + xy_z)^2 + (xy_z + yz_x)^2]
//     c_e = mu a eta_e / 16,  eta_e = [nu + sqrt((1 + nu)^2 + 1)] / 3
//     c_d = mu a eta_d / 16,  eta_d = 1/3
//
// f: share of the cell's volume V = a^3 inside the body; f^3 is never taken below f/1000. W_q is
// the deviations' part of the 18 connections of stiffness mu a, edges counted eta_e and diagonals
// eta_d times: with these a cell bends and twists as a slice of a beam does. Strain and modes are
// functions of C and F^T Q alone, which a rotation leaves as they are: none is ever split off.
//
// Plastic flow after von Mises, of mean and deviations by one factor w, with linear hardening:
//
//     s = 2 mu dev(E - E_p)
//     t^2 = 3/2 [s : s + 4 mu f^2 W_q(q - q_p) / V]          equivalent stress [Pa]
//     t > sigma_y + H alpha:    d_alpha = (t - sigma_y - H alpha) / (3 mu + H)
//                               w = 1 - 3 mu d_alpha / t
//                               E_p += (1 - w) dev(E - E_p)
//                               q_p += (1 - w)(q - q_p),  alpha += d_alpha
//
// The history (E_p, q_p, alpha) has a committed value; every evaluation returns from it and leaves
// no trace. Forces are the exact gradient of the increment's energy.
//
// Rubber is W = f V [mu (|F|^2 - 3)/2 - mu (J - 1) + (lambda + mu)(J - 1)^2 / 2] + f^3 W_q with
// J = det F, which resists being turned inside out (Smith, de Goes, Kim, "Stable neo-Hookean flesh
// simulation", ACM Trans. Graph. 37, 2018, without its logarithm).
//
// NOTE: the papers have springs alone, whose Poisson's ratio is 1/4 and which are too stiff in
// bending and torsion on coarse lattices.
#pragma once

#include "laws/cell_moduli.h"
#include "laws/lane_tensor.h"

namespace swage {

// How the eight corners stand: D_j and Q_m, sums over the corners with the signs s_j and h_m.
template <typename N>
struct CornerSums {
    Triple<N> x, y, z;          // D [m]
    Triple<N> xy, yz, zx, xyz;  // Q [m]
};

// Four sums of one component of the corners (bit 0 along x, bit 1 along y, bit 2 along z).
template <typename N>
SWAGE_INLINE void sum_corners(const N (&c)[8], N& x, N& y, N& z, N& xy, N& yz, N& zx, N& xyz) {
    const N a0 = c[0] + c[1], d0 = c[1] - c[0], a1 = c[2] + c[3], d1 = c[3] - c[2];
    const N a2 = c[4] + c[5], d2 = c[5] - c[4], a3 = c[6] + c[7], d3 = c[7] - c[6];
    const N dl = d0 + d1, dh = d2 + d3, el = d1 - d0, eh = d3 - d2;
    x = dl + dh, zx = dh - dl, xy = el + eh, xyz = eh - el;
    const N al = a0 + a1, ah = a2 + a3, bl = a1 - a0, bh = a3 - a2;
    z = ah - al, y = bl + bh, yz = bh - bl;
}
// And back: what each corner gets of a force on each sum.
template <typename N>
SWAGE_INLINE void spread_corners(const N& x, const N& y, const N& z, const N& xy, const N& yz,
                                 const N& zx, const N& xyz, N (&c)[8]) {
    const N xl = x - zx, xh = x + zx, el = xy - xyz, eh = xy + xyz;
    const N d0 = xl - el, d1 = xl + el, d2 = xh - eh, d3 = xh + eh;
    const N yl = y - yz, yh = y + yz;
    const N a0 = -z - yl, a1 = yl - z, a2 = z - yh, a3 = z + yh;
    c[0] = a0 - d0, c[1] = a0 + d0, c[2] = a1 - d1, c[3] = a1 + d1;
    c[4] = a2 - d2, c[5] = a2 + d2, c[6] = a3 - d3, c[7] = a3 + d3;
}

// The modes of the corners in the material's axes.
template <typename N>
struct CellModes {
    Triple<N> xy, yz, zx, xyz;
};
template <typename N>
SWAGE_INLINE CellModes<N> operator-(const CellModes<N>& a, const CellModes<N>& b) {
    return {a.xy - b.xy, a.yz - b.yz, a.zx - b.zx, a.xyz - b.xyz};
}
template <typename N>
SWAGE_INLINE CellModes<N> operator*(const N& s, const CellModes<N>& a) {
    return {s * a.xy, s * a.yz, s * a.zx, s * a.xyz};
}

// Gradient of W_q; W_q is half its product with q.
template <typename N>
SWAGE_INLINE CellModes<N> mode_stress(const CellModuli& law, const CellModes<N>& q) {
    const N xx = law.diagonal * (q.yz.y + q.zx.x), yy = law.diagonal * (q.yz.z + q.xy.x),
            zz = law.diagonal * (q.zx.z + q.xy.y);
    const N u = law.diagonal * (q.yz.x + q.zx.y), v = law.diagonal * (q.zx.y + q.xy.z),
            w = law.diagonal * (q.xy.z + q.yz.x);
    const double e = law.edge;
    return {{e * q.xy.x + yy, e * q.xy.y + zz, v + w},
            {w + u, e * q.yz.y + xx, e * q.yz.z + yy},
            {e * q.zx.x + xx, u + v, e * q.zx.z + zz},
            {e * q.xyz.x, e * q.xyz.y, e * q.xyz.z}};
}
template <typename N>
SWAGE_INLINE N product(const CellModes<N>& a, const CellModes<N>& b) {
    return dot(a.xy, b.xy) + dot(a.yz, b.yz) + dot(a.zx, b.zx) + dot(a.xyz, b.xyz);
}

// The cell's state as seen from the centroid of its material, which lies at (xi, eta, zeta), each
// -1 to 1, in the cell.
template <typename N>
SWAGE_INLINE Columns<N> centroid_gradient(const CornerSums<N>& c, const Triple<N>& at,
                                          double spacing) {
    const double s = 0.25 / spacing;
    const N xi = s * at.x, eta = s * at.y, zeta = s * at.z;
    const N one = s + 0.0 * at.x;
    return {one * c.x + eta * c.xy + zeta * c.zx + (eta * at.z) * c.xyz,
            one * c.y + xi * c.xy + zeta * c.yz + (xi * at.z) * c.xyz,
            one * c.z + eta * c.yz + xi * c.zx + (xi * at.y) * c.xyz};
}

// The logarithmic strain and what its gradient needs.
template <typename N>
struct CellStrain {
    Symmetric<N> log;             // E
    Symmetric<N> cayley, square;  // Y, Y^2
    Symmetric<N> inner;           // (C + I)^-1
};
template <typename N>
SWAGE_INLINE CellStrain<N> cell_strain(const Columns<N>& f) {
    CellStrain<N> e;
    e.inner = inverse(Symmetric<N>{dot(f.x, f.x) + 1.0, dot(f.y, f.y) + 1.0, dot(f.z, f.z) + 1.0,
                                   dot(f.x, f.y), dot(f.y, f.z), dot(f.z, f.x)});
    const Symmetric<N>& g = e.inner;
    e.cayley = {1.0 - 2.0 * g.xx, 1.0 - 2.0 * g.yy, 1.0 - 2.0 * g.zz,
                -2.0 * g.xy,      -2.0 * g.yz,      -2.0 * g.zx};
    e.square = square(e.cayley);
    // Y (I + Y^2 (I/3 + Y^2/5)), all of which commute.
    const Symmetric<N>& a = e.square;
    Symmetric<N> series = {0.2 * a.xx + 1.0 / 3, 0.2 * a.yy + 1.0 / 3, 0.2 * a.zz + 1.0 / 3,
                           0.2 * a.xy,           0.2 * a.yz,           0.2 * a.zx};
    series = commuting(a, series);
    series.xx = series.xx + 1.0, series.yy = series.yy + 1.0, series.zz = series.zz + 1.0;
    e.log = commuting(e.cayley, series);
    return e;
}

// The second Piola-Kirchhoff stress of the conjugate of E: dW/dE turned into 2 dW/dC.
template <typename N>
SWAGE_INLINE Symmetric<N> material_stress(const CellStrain<N>& e, const Symmetric<N>& t) {
    const N third = 1.0 / 3 + 0.0 * t.xx, fifth = 0.2 + 0.0 * t.xx, four = 4.0 + 0.0 * t.xx;
    const Symmetric<N>&y = e.cayley, &a = e.square;
    const Symmetric<N> ta = both_ways(t, a);
    const Symmetric<N> cube = ta + sandwich(y, t);
    const Symmetric<N> fifth_power = both_ways(t, square(a)) + sandwich(y, ta) + sandwich(a, t);
    return four * sandwich(e.inner, t + third * cube + fifth * fifth_power);
}

// What a cell has flowed, committed.
template <typename N>
struct CellHistory {
    Symmetric<N> strain;  // E_p; its trace is zero
    CellModes<N> modes;   // q_p [m]
    N alpha;
};

// Trial state and return.
template <typename N>
struct CellFlowed {
    Symmetric<N> distortion;  // dev(E - E_p) before the return
    CellModes<N> modes;       // q - q_p before the return
    N trace;
    N kept;  // w
    N d_alpha;
};

template <typename N>
SWAGE_INLINE Symmetric<N> deviator(const Symmetric<N>& e) {
    const N third = (1.0 / 3) * trace(e);
    return {e.xx - third, e.yy - third, e.zz - third, e.xy, e.yz, e.zx};
}

template <typename N>
SWAGE_INLINE CellFlowed<N> flow_cell(const CellModuli& law, const CellHistory<N>& history,
                                     const Symmetric<N>& strain, const CellModes<N>& modes,
                                     const N& fill) {
    CellFlowed<N> r;
    r.trace = trace(strain);
    r.distortion = deviator(strain) - history.strain;
    r.modes = modes - history.modes;
    const double volume = law.spacing * law.spacing * law.spacing;
    const N n2 =
        (4 * law.shear * law.shear) * contract(r.distortion, r.distortion) +
        (2 * law.shear / volume) * (fill * fill) * product(mode_stress(law, r.modes), r.modes);
    const N stress = root(1.5 * n2) + 1e-300;
    const N over = stress - law.yield_stress - law.hardening * history.alpha;
    const N zero = 0.0 * stress;
    r.d_alpha = larger(over, zero) * (1 / (3 * law.shear + law.hardening));
    r.kept = 1.0 - (3 * law.shear) * r.d_alpha / stress;
    return r;
}

// Energy of the mean strain, elastic part, per volume of material.
template <typename N>
SWAGE_INLINE N strain_energy(const CellModuli& law, const Symmetric<N>& strain,
                             const CellHistory<N>& history) {
    const Symmetric<N> e = deviator(strain) - history.strain;
    const N size = trace(strain);
    return law.shear * contract(e, e) + (0.5 * law.bulk) * size * size;
}

// Rubber: energy per volume of material, and its gradient dW/dF.
template <typename N>
SWAGE_INLINE N rubber_energy(const CellModuli& law, const Columns<N>& f) {
    const N grown = dot(f.x, cross(f.y, f.z)) - 1.0;
    const double lame = law.bulk - 2.0 / 3 * law.shear;
    return (0.5 * law.shear) * (dot(f.x, f.x) + dot(f.y, f.y) + dot(f.z, f.z) - 3.0) -
           law.shear * grown + (0.5 * (lame + law.shear)) * grown * grown;
}
template <typename N>
SWAGE_INLINE Columns<N> rubber_stress(const CellModuli& law, const Columns<N>& f) {
    const Columns<N> cofactor = {cross(f.y, f.z), cross(f.z, f.x), cross(f.x, f.y)};
    const double lame = law.bulk - 2.0 / 3 * law.shear;
    const N pressure = (lame + law.shear) * (dot(f.x, cofactor.x) - 1.0) - law.shear;
    const N mu = law.shear + 0.0 * pressure;
    return {mu * f.x + pressure * cofactor.x, mu * f.y + pressure * cofactor.y,
            mu * f.z + pressure * cofactor.z};
}

// Forces that the cell exerts on its corners, as forces on their sums: from p = dW/dF and g, the
// stress of the modes.
template <typename N>
SWAGE_INLINE CornerSums<N> sum_forces(const CornerSums<N>& c, const Columns<N>& f, Columns<N> p,
                                      const CellModes<N>& g, const Triple<N>& at, double spacing) {
    p.x = p.x + (g.xy.x * c.xy + g.yz.x * c.yz + g.zx.x * c.zx + g.xyz.x * c.xyz);
    p.y = p.y + (g.xy.y * c.xy + g.yz.y * c.yz + g.zx.y * c.zx + g.xyz.y * c.xyz);
    p.z = p.z + (g.xy.z * c.xy + g.yz.z * c.yz + g.zx.z * c.zx + g.xyz.z * c.xyz);
    const N s = -0.25 / spacing + 0.0 * at.x, minus = -1.0 + 0.0 * at.x;
    p = {s * p.x, s * p.y, s * p.z};
    CornerSums<N> r;
    r.x = p.x, r.y = p.y, r.z = p.z;
    r.xy = minus * (f * g.xy) + at.y * p.x + at.x * p.y;
    r.yz = minus * (f * g.yz) + at.z * p.y + at.y * p.z;
    r.zx = minus * (f * g.zx) + at.z * p.x + at.x * p.z;
    r.xyz = minus * (f * g.xyz) + (at.y * at.z) * p.x + (at.x * at.z) * p.y + (at.x * at.y) * p.z;
    return r;
}

}  // namespace swage
