// SPDX-License-Identifier: GPL-3.0-or-later
// A cell of eight particles as matter: the mean of its connections' strains carries Hooke's law for
// any Poisson's ratio, their deviations carry bending and twist.
//
//     F = grad x at the centroid of the cell's material
//     A = U_p^-1, det A = 1                                  takes back the stretch that has flowed
//     F_e = F A, C = F_e^T F_e
//     Y = (C - I)(C + I)^-1                                  Cayley strain, tanh(ln U_e)
//     E = Y + Y^3/3 + Y^5/5                                  ln U_e but for |E|^7/7
//     theta = y + y^3/3 + y^5/5, y = (J^2 - 1)/(J^2 + 1)     ln J in the same way, J = det F
//     Q_m = sum of h_m x over the corners [m]                m = xy, yz, zx, xyz; h_xy = s_x s_y,
//     ...; q_m = F_e^T Q_m - p_m                                  s = -1, +1 at the two ends of an
//     axis; p_m: what has flowed of it
//
//     W = f V [mu |dev E|^2 + K theta^2 / 2] + f^3 W_q       [J]
//     W_q = c_e/2 [xy_x^2 + xy_y^2 + yz_y^2 + yz_z^2 + zx_z^2 + zx_x^2 + |xyz|^2]
//         + c_d/2 [(yz_y + zx_x)^2 + (yz_z + xy_x)^2 + (zx_z + xy_y)^2
//                + (yz_x + zx_y)^2 + (zx_y + xy_z)^2 + (xy_z + yz_x)^2]
//     c_e = mu a eta_e / 16,  eta_e = [nu + sqrt((1 + nu)^2 + 1)] / 3
//     c_d = mu a eta_d / 16,  eta_d = 1/3
//
// f: share of the cell's volume V = a^3 inside the body; f^2 is never taken below 0.03. W_q is
// the deviations' part of the 18 connections of stiffness mu a, edges counted eta_e and diagonals
// eta_d times: with these a cell bends and twists as a slice of a beam does. Strain and modes are
// functions of C and F^T Q alone, which a rotation leaves as they are: none is ever split off.
//
// Plastic flow after von Mises, of mean and deviations by one factor w, with linear hardening, or
// on a line of a flow curve (laws/cell_return.h):
//
//     s = 2 mu dev E
//     t^2 = 3/2 [s : s + 4 mu f^2 W_q / V]                   equivalent stress [Pa]
//     t > sigma_y + H alpha:    d_alpha = (t - sigma_y - H alpha) / (3 mu + H)
//                               w = 1 - 3 mu d_alpha / t
//                               A <- root of A exp(-2 (1 - w) dev E) A
//                               A q <- w A q,  alpha += d_alpha
//
// The modes of slivers, f < 0.06, flow by themselves: t of E alone, and
//
//     t_q^2 = 6 mu f^2 W_q / V
//     t_q > t_y = n (sigma_y + H alpha):  d_alpha = (t_q - t_y) / (3 mu) more
//                                         A q <- t_y / t_q A q
//
//
// so that what flows stays elastic strain and stress, and only these, however far it has gone; all
// tensors of the return are functions of E. The exponential keeps the volume.
//
// theta and not tr E, which is its equal where strains are small: of a cell drawn to 2 x 2 x 1/4
// the trace is 0.16.
//
// The history (A, p, alpha) has a committed value; every evaluation returns from it and leaves
// no trace. Forces are the exact gradient of the increment's energy.
//
// Source of the split F = F_e F_p and its return in logarithms: J. Simo, "Algorithms for static and
// dynamic multiplicative plasticity that preserve the classical return mapping schemes of the
// infinitesimal theory", Comput. Methods Appl. Mech. Eng. 99, 1992.
// NOTE: the logarithm of F less one that has flowed, which was here before, ends at infinite
// stretch with 1.5: a block pressed to a quarter of its height bore a third of what it should.
//
// Rubber is W = f V [mu (|F|^2 - 3)/2 - mu (J - 1) + (lambda + mu)(J - 1)^2 / 2] + f^3 W_q with
// J = det F, which resists being turned inside out (Smith, de Goes, Kim, "Stable neo-Hookean flesh
// simulation", ACM Trans. Graph. 37, 2018, without its logarithm). Foam: laws/cell_foam.h.
//
// NOTE: the papers have springs alone, whose Poisson's ratio is 1/4 and which are too stiff in
// bending and torsion on coarse lattices.
#pragma once

#include "laws/cell_return.h"

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
// The same of all three components.
template <typename N>
SWAGE_INLINE CornerSums<N> sum_corners(const N (&c)[3][8]) {
    CornerSums<N> s;
    sum_corners(c[0], s.x.x, s.y.x, s.z.x, s.xy.x, s.yz.x, s.zx.x, s.xyz.x);
    sum_corners(c[1], s.x.y, s.y.y, s.z.y, s.xy.y, s.yz.y, s.zx.y, s.xyz.y);
    sum_corners(c[2], s.x.z, s.y.z, s.z.z, s.xy.z, s.yz.z, s.zx.z, s.xyz.z);
    return s;
}
template <typename N>
SWAGE_INLINE void spread_corners(const CornerSums<N>& s, N (&c)[3][8]) {
    spread_corners(s.x.x, s.y.x, s.z.x, s.xy.x, s.yz.x, s.zx.x, s.xyz.x, c[0]);
    spread_corners(s.x.y, s.y.y, s.z.y, s.xy.y, s.yz.y, s.zx.y, s.xyz.y, c[1]);
    spread_corners(s.x.z, s.y.z, s.z.z, s.xy.z, s.yz.z, s.zx.z, s.xyz.z, c[2]);
}

// The modes of the corners in the material's axes.
template <typename N>
struct CellModes {
    Triple<N> xy, yz, zx, xyz;
};
template <typename N>
SWAGE_INLINE CellModes<N> operator+(const CellModes<N>& a, const CellModes<N>& b) {
    return {a.xy + b.xy, a.yz + b.yz, a.zx + b.zx, a.xyz + b.xyz};
}
template <typename N>
SWAGE_INLINE CellModes<N> operator-(const CellModes<N>& a, const CellModes<N>& b) {
    return {a.xy - b.xy, a.yz - b.yz, a.zx - b.zx, a.xyz - b.xyz};
}
template <typename S, typename N>
SWAGE_INLINE CellModes<N> operator*(const S& s, const CellModes<N>& a) {
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
// The same of a cell that has flowed. One plane's part: of two modes' components in it, and what
// these are given.
template <typename N>
SWAGE_INLINE void add_plane_stress(const CellModuli& law, const N& a11, const N& a12, const N& a22,
                                   const N& u1, const N& u2, const N& v1, const N& v2, N& to_u1,
                                   N& to_u2, N& to_v1, N& to_v2) {
    const N s11 = a11 * u1 + a12 * v1, s12 = a11 * u2 + a12 * v2;
    const N s21 = a12 * u1 + a22 * v1, s22 = a12 * u2 + a22 * v2;
    const N both = law.diagonal * (s11 + s22), cross = law.diagonal * (s12 + s21);
    const N t11 = law.edge * s11 + both, t22 = law.edge * s22 + both;
    to_u1 = to_u1 + (a11 * t11 + a12 * cross), to_u2 = to_u2 + (a11 * cross + a12 * t22);
    to_v1 = to_v1 + (a12 * t11 + a22 * cross), to_v2 = to_v2 + (a12 * cross + a22 * t22);
}
template <typename N>
SWAGE_INLINE CellModes<N> mode_stress(const CellModuli& law, const Symmetric<N>& a,
                                      const CellModes<N>& q) {
    CellModes<N> g{};
    add_plane_stress(law, a.yy, a.yz, a.zz, q.xy.y, q.xy.z, q.zx.y, q.zx.z, g.xy.y, g.xy.z, g.zx.y,
                     g.zx.z);
    add_plane_stress(law, a.xx, a.zx, a.zz, q.xy.x, q.xy.z, q.yz.x, q.yz.z, g.xy.x, g.xy.z, g.yz.x,
                     g.yz.z);
    add_plane_stress(law, a.xx, a.xy, a.yy, q.zx.x, q.zx.y, q.yz.x, q.yz.y, g.zx.x, g.zx.y, g.yz.x,
                     g.yz.y);
    g.xyz = law.edge * (a * (a * q.xyz));
    return g;
}
template <typename N>
SWAGE_INLINE N product(const CellModes<N>& a, const CellModes<N>& b) {
    return dot(a.xy, b.xy) + dot(a.yz, b.yz) + dot(a.zx, b.zx) + dot(a.xyz, b.xyz);
}

// What stresses of the modes along one of the material's axes do to the gradient there.
template <typename N>
SWAGE_INLINE Triple<N> pulled_by(const N& xy, const N& yz, const N& zx, const N& xyz,
                                 const CornerSums<N>& c) {
    return xy * c.xy + yz * c.yz + zx * c.zx + xyz * c.xyz;
}

// The cell's state as seen from the centroid of its material, which lies at (xi, eta, zeta), each
// -1 to 1, in the cell: 4 a F.
template <typename N>
SWAGE_INLINE Columns<N> centroid_sums(const CornerSums<N>& c, const Triple<N>& at) {
    return {c.x + at.y * c.xy + at.z * c.zx + (at.y * at.z) * c.xyz,
            c.y + at.x * c.xy + at.z * c.yz + (at.x * at.z) * c.xyz,
            c.z + at.y * c.yz + at.x * c.zx + (at.x * at.y) * c.xyz};
}
template <typename N>  // F
SWAGE_INLINE Columns<N> centroid_gradient(const CornerSums<N>& c, const Triple<N>& at,
                                          double spacing) {
    const Columns<N> d = centroid_sums(c, at);
    const double s = 0.25 / spacing;
    return {s * d.x, s * d.y, s * d.z};
}
template <typename N>
SWAGE_INLINE CellModes<N> pulled_back(const Columns<N>& f, const CornerSums<N>& c) {
    return {transposed_times(f, c.xy), transposed_times(f, c.yz), transposed_times(f, c.zx),
            transposed_times(f, c.xyz)};
}

// a + b Y + c Y^2, which every function of Y alone can be written as (Cayley and Hamilton).
template <typename N>
struct CayleySeries {
    N a, b, c;
};
template <typename N>
SWAGE_INLINE CayleySeries<N> operator+(const CayleySeries<N>& p, const CayleySeries<N>& q) {
    return {p.a + q.a, p.b + q.b, p.c + q.c};
}
template <typename N>
SWAGE_INLINE CayleySeries<N> operator*(const N& s, const CayleySeries<N>& p) {
    return {s * p.a, s * p.b, s * p.c};
}
template <typename N>
SWAGE_INLINE CayleySeries<N> operator-(const CayleySeries<N>& p, const CayleySeries<N>& q) {
    return {p.a - q.a, p.b - q.b, p.c - q.c};
}

// The logarithmic strain and what its gradient needs.
template <typename N>
struct CellStrain {
    Symmetric<N> log;             // E
    Symmetric<N> cayley, square;  // Y, Y^2
    N i1, i2, i3;                 // Y's invariants: Y^3 = i1 Y^2 - i2 Y + i3
    CayleySeries<N> series;       // of E
    N size, over;                 // y of J; 1 / (1 + i2)
};
template <typename N>
SWAGE_INLINE CayleySeries<N> times_cayley(const CellStrain<N>& e, const CayleySeries<N>& p) {
    return {e.i3 * p.c, p.a - e.i2 * p.c, p.b + e.i1 * p.c};
}
template <typename N>
SWAGE_INLINE Symmetric<N> evaluate(const CellStrain<N>& e, const CayleySeries<N>& p) {
    const Symmetric<N>&y = e.cayley, &s = e.square;
    return {p.b * y.xx + p.c * s.xx + p.a, p.b * y.yy + p.c * s.yy + p.a,
            p.b * y.zz + p.c * s.zz + p.a, p.b * y.xy + p.c * s.xy,
            p.b * y.yz + p.c * s.yz,       p.b * y.zx + p.c * s.zx};
}
// From C + I.
template <typename N>
SWAGE_INLINE CellStrain<N> strain_of_sum(const Symmetric<N>& m) {
    CellStrain<N> e;
    // Y = I - 2 (C + I)^-1. J^2 = det C follows from the invariants of C + I; both are divided at
    // once.
    const N xx = m.yy * m.zz - m.yz * m.yz, xy = m.yz * m.zx - m.xy * m.zz,
            zx = m.xy * m.yz - m.yy * m.zx;
    const N yy = m.xx * m.zz - m.zx * m.zx, zz = m.xx * m.yy - m.xy * m.xy;
    const N det = m.xx * xx + m.xy * xy + m.zx * zx;
    const N size = det - (xx + yy + zz) + trace(m), inverse = 1.0 / (det * size);  // J^2 + 1
    const N over = -2.0 * size * inverse, over_size = det * inverse;
    e.size = (size - 2.0) * over_size;
    e.over = 0.25 * det * over_size;
    e.cayley = {1.0 + over * xx,
                1.0 + over * yy,
                1.0 + over * zz,
                over * xy,
                over * (m.xy * m.zx - m.xx * m.yz),
                over * zx};
    const Symmetric<N>& y = e.cayley;
    e.square = square(y);
    const N minor = y.yy * y.zz - y.yz * y.yz;
    e.i1 = trace(y);
    e.i2 = minor + (y.xx * y.zz - y.zx * y.zx) + (y.xx * y.yy - y.xy * y.xy);
    e.i3 = y.xx * minor + y.xy * (y.yz * y.zx - y.xy * y.zz) + y.zx * (y.xy * y.yz - y.yy * y.zx);
    // Y + Y^3/3 + Y^5/5
    const N p = e.i1 * e.i1 - e.i2;
    e.series = {e.i3 * (1.0 / 3 + 0.2 * p), 1.0 - (1.0 / 3) * e.i2 + 0.2 * (e.i1 * e.i3 - e.i2 * p),
                (1.0 / 3) * e.i1 + 0.2 * (e.i1 * (p - e.i2) + e.i3)};
    e.log = evaluate(e, e.series);
    return e;
}
template <typename N>
SWAGE_INLINE CellStrain<N> cell_strain(const Columns<N>& f) {
    return strain_of_sum(Symmetric<N>{dot(f.x, f.x) + 1.0, dot(f.y, f.y) + 1.0, dot(f.z, f.z) + 1.0,
                                      dot(f.x, f.y), dot(f.y, f.z), dot(f.z, f.x)});
}

// theta, and 2 dtheta/dC = (1 - y^6) C^-1 as a function of Y, which det(I + Y) = (1 + i2)(1 + y)
// divides.
template <typename N>
struct CellSize {
    N log;
    CayleySeries<N> slope;
};
template <typename N>
SWAGE_INLINE CellSize<N> cell_size(const CellStrain<N>& e) {
    const N y = e.size, y2 = y * y, one = 1.0 + e.i1;
    const N rate = (1.0 + y2 * (1.0 + y2)) * (1.0 - y) * e.over;
    return {y * (1.0 + y2 * (1.0 / 3 + 0.2 * y2)),
            {rate * (one + e.i2 - e.i3), -2.0 * rate * one, 2.0 * rate}};
}

// The second Piola-Kirchhoff stress of the conjugate of E, a function of Y: dW/dE turned into
// 2 dW/dC, (I - Y)^2 (I + Y^2 + Y^4) t. The powers are written out, which is longer than
// multiplying by Y again and again, but none waits for another.
template <typename N>
SWAGE_INLINE CayleySeries<N> material_stress(const CellStrain<N>& e, const CayleySeries<N>& t) {
    const N p = e.i1 * e.i1 - e.i2, q = e.i1 * e.i3;
    const CayleySeries<N> y3 = {e.i3, -1.0 * e.i2, e.i1};
    const CayleySeries<N> y4 = {q, e.i3 - e.i1 * e.i2, p};
    const CayleySeries<N> y5 = {e.i3 * p, q - e.i2 * p, e.i1 * (p - e.i2) + e.i3};
    const CayleySeries<N> y6 = times_cayley(e, y5), odd = y4 - y3 - y5;
    const CayleySeries<N> m = {1.0 + 2.0 * odd.a + y6.a, 2.0 * odd.b + y6.b - 2.0,
                               2.0 + 2.0 * odd.c + y6.c};
    const N m3 = m.b * t.c + m.c * t.b, m4 = m.c * t.c;
    return {m.a * t.a + (m3 * y3.a + m4 * y4.a), (m.a * t.b + m.b * t.a) + (m3 * y3.b + m4 * y4.b),
            (m.a * t.c + m.b * t.b + m.c * t.a) + (m3 * y3.c + m4 * y4.c)};
}

// E without its trace, as a function of Y.
template <typename N>
SWAGE_INLINE CayleySeries<N> deviator_series(const CellStrain<N>& e) {
    const N third = (1.0 / 3) * (e.i1 * e.series.b + trace(e.square) * e.series.c);
    return {-1.0 * third, e.series.b, e.series.c};
}
// 2 dw/dC per volume of material, where the share `kept` of the distortion is elastic.
template <typename N>
SWAGE_INLINE Symmetric<N> cell_stress(const CellModuli& law, const CellStrain<N>& e,
                                      const N& kept) {
    const CellSize<N> size = cell_size(e);
    const N shear = (2 * law.shear) * kept;
    return evaluate(
        e, material_stress(e, shear * deviator_series(e)) + (law.bulk * size.log) * size.slope);
}

// f^2, which alone leaves nothing to hold a sliver's corners; and f times that.
template <typename N>
SWAGE_INLINE N mode_share(const N& fill) {
    return larger(fill * fill, kLeastModeFill + N{});
}
template <typename N>
SWAGE_INLINE N mode_fill(const N& fill) {
    return fill * mode_share(fill);
}

// Whether the modes of a cell flow as its mean does, 1 or 0. NOTE: where those of slivers did,
// corners that no other cell has went off by up to 28 cells as bodies were twisted or pressed far,
// for that takes the strain off the sliver; and they do where these flow by themselves at the yield
// stress itself, as what is forced on them now and then lets the rest creep. Where they do not flow
// at all, what is twisted asks for up to 15 % more.
template <typename N>
SWAGE_INLINE N mode_flow(const N& fill) {
    const N lacks = larger(kFlowingFill - fill, 0.0 * fill);
    return larger(1.0 - 1e300 * lacks, 0.0 * fill);
}

// What is left of modes.
template <typename N>
SWAGE_INLINE N kept_of_modes(const N& flow, const CellReturn<N>& r, const ModesReturn<N>& alone) {
    return 1.0 - flow * (1.0 - r.kept) - (1.0 - flow) * (1.0 - alone.kept);
}

// What a cell has flowed, committed.
template <typename N>
struct CellHistory {
    Symmetric<N> stretch;  // A - I
    CellModes<N> modes;    // p [m]
    N alpha;
};
// Calls see(n, number) for all numbers of a strain and its modes, in the order in which they are
// kept.
template <typename Strain, typename Modes, typename See>
SWAGE_INLINE void for_each_number(Strain& e, Modes& q, const See& see) {
    int n = 0;
    const auto each = [&](auto&... number) __attribute__((always_inline)) {
        (see(n++, number), ...);
    };
    each(e.xx, e.yy, e.zz, e.xy, e.yz, e.zx);
    const auto triple = [&](auto& v) __attribute__((always_inline)) { each(v.x, v.y, v.z); };
    triple(q.xy), triple(q.yz), triple(q.zx), triple(q.xyz);
}
// Of a history: as these, and alpha last.
template <typename History, typename See>
SWAGE_INLINE void for_each_number(History& history, const See& see) {
    for_each_number(history.stretch, history.modes, see);
    see(18, history.alpha);
}
template <typename N>  // A
SWAGE_INLINE Symmetric<N> taken_back(const CellHistory<N>& history) {
    return plus_unit(history.stretch, 1.0);
}

// Trial state and return.
template <typename N>
struct CellFlowed : CellReturn<N> {
    Symmetric<N> distortion;   // dev E before the return
    CellModes<N> modes;        // q before the return
    CellModes<N> mode_stress;  // of these
    N kept_modes;              // of them, 1 where they do not flow
    ModesReturn<N> alone;      // of a sliver's
    SWAGE_INLINE N whole_d_alpha() const { return this->d_alpha + alone.d_alpha; }
};

template <typename N>
SWAGE_INLINE Symmetric<N> deviator(const Symmetric<N>& e) {
    const N third = (1.0 / 3) * trace(e);
    return {e.xx - third, e.yy - third, e.zz - third, e.xy, e.yz, e.zx};
}

// `strain`, `modes`: E and F_e^T Q.
template <typename N>
SWAGE_INLINE CellFlowed<N> flow_cell(const CellModuli& law, const CellHistory<N>& history,
                                     const Symmetric<N>& strain, const CellModes<N>& modes,
                                     const N& fill) {
    CellFlowed<N> r;
    r.distortion = deviator(strain);
    r.modes = modes - history.modes;
    r.mode_stress = mode_stress(law, taken_back(history), r.modes);
    const N flow = mode_flow(fill), energy = product(r.mode_stress, r.modes);
    static_cast<CellReturn<N>&>(r) = return_cell(law, contract(r.distortion, r.distortion),
                                                 (flow * mode_share(fill)) * energy, history.alpha);
    r.alone = return_modes(law, r, ((1.0 - flow) * mode_share(fill)) * energy, history.alpha);
    r.kept_modes = kept_of_modes(flow, r, r.alone);
    return r;
}

// Energy of the mean strain, elastic part, per volume of material.
template <typename N>
SWAGE_INLINE N strain_energy(const CellModuli& law, const CellStrain<N>& strain) {
    const Symmetric<N> e = deviator(strain.log);
    const N size = cell_size(strain).log;
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
    return {law.shear * f.x + pressure * cofactor.x, law.shear * f.y + pressure * cofactor.y,
            law.shear * f.z + pressure * cofactor.z};
}

// The lever of a force on D through the centroid, back on the sums.
template <typename N>
SWAGE_INLINE void add_levers(const Columns<N>& p, const Triple<N>& at, CornerSums<N>& r) {
    r.xy = r.xy + at.y * p.x + at.x * p.y;
    r.yz = r.yz + at.z * p.y + at.y * p.z;
    r.zx = r.zx + at.z * p.x + at.x * p.z;
    r.xyz = r.xyz + (at.y * at.z) * p.x + (at.x * at.z) * p.y + (at.x * at.y) * p.z;
}

// Forces that the cell exerts on its corners, as forces on their sums: from p = dW/dF, the stress g
// of the modes, and F_e and A.
template <typename N>
SWAGE_INLINE CornerSums<N> sum_forces(const CornerSums<N>& c, const Columns<N>& elastic,
                                      const Symmetric<N>& a, Columns<N> p, const CellModes<N>& g,
                                      const Triple<N>& at, double spacing) {
    const double s = -0.25 / spacing;
    const Columns<N> m = Columns<N>{pulled_by(g.xy.x, g.yz.x, g.zx.x, g.xyz.x, c),
                                    pulled_by(g.xy.y, g.yz.y, g.zx.y, g.xyz.y, c),
                                    pulled_by(g.xy.z, g.yz.z, g.zx.z, g.xyz.z, c)} *
                         a;
    p = {s * (p.x + m.x), s * (p.y + m.y), s * (p.z + m.z)};
    CornerSums<N> r{p.x,
                    p.y,
                    p.z,
                    -1.0 * (elastic * g.xy),
                    -1.0 * (elastic * g.yz),
                    -1.0 * (elastic * g.zx),
                    -1.0 * (elastic * g.xyz)};
    add_levers(p, at, r);
    return r;
}

}  // namespace swage
