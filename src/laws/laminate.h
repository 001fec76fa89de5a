// SPDX-License-Identifier: GPL-3.0-or-later
// A cell that the plane boundary of two materials crosses. Each obeys its own law (laws/cell.h)
// with its own share of the cell, seen from its own centroid; across the boundary the gradient may
// jump along the normal n, by as much as lets the traction pass:
//
//     F_1 = F(c_1) + (f_2 / f) a n^T        F_2 = F(c_2) - (f_1 / f) a n^T       f = f_1 + f_2
//     W = sum of f_m V w_m(F_m A_m) + f_m^3 W_q,m((F(c_m) A_m)^T Q - p_m)         [J]
//     a minimises W:   (P_1 - P_2) n = 0,   P_m = dw_m/dF_m                       [Pa]
//
// so that layers in series share the stress and layers side by side the strain. By the minimum the
// forces are the gradient of W with a held. Where a material can flow, w_m is what its increment
// from the committed history takes, which is convex too. Plastic flow couples strain and modes
// within each material as in laws/cell.h. What is crushed more than its cell has the guard of
// laws/layer_guard.h besides: its law alone turns back, and W would have a second minimum in which
// the softer one is inside out.
//
// Source of the jump: rank-one laminates, e.g. G. Milton, "The theory of composites", 2002, ch. 9.
// a is found by Broyden's method from the laminate of small strains (C. Broyden, "A class of
// methods for solving nonlinear simultaneous equations", Math. Comp. 19, 1965), and where that
// takes long, as it does when flow sets in, by Newton's with the exact tangent. No step goes where
// W has risen steeply again.
//
// NOTE: strained by 0.02 in one increment, ten times what it yields at, every cell of thousands
// finds its jump, and by 0.05 where its materials harden; without hardening one in a hundred does
// not. At 0.2, where W is not convex any more, one in fifty, and without hardening one in five: its
// two sides then carry tractions that differ.
#pragma once

#include "laws/cell_forces.h"
#include "laws/dual.h"
#include "laws/layer_guard.h"

namespace swage {

template <typename N>
struct Phase {
    const CellModuli* law;
    CellKind kind;  // of all lanes
    N fill;
    Triple<N> at;  // centroid, -1 to 1
    CellHistory<N> history;
};

template <typename N>
struct PhaseState {
    Columns<N> gradient;       // F(c_m)
    CellModes<N> modes;        // (F(c_m) A_m)^T Q
    Columns<N> stress;         // P_m [Pa]
    Columns<N> whole_stress;   // what F(c_m) does to w_m besides [Pa]
    CellModes<N> mode_stress;  // dW_q/dq of a whole cell
    CellFlowed<N> flowed;      // of what yields
};

template <typename N>
SWAGE_INLINE const Columns<N>& turned_by(const Columns<N>& f, double) {
    return f;
}
template <typename N>
SWAGE_INLINE Columns<Dual<N>> turned_by(const Columns<Dual<N>>& f, double turning) {
    return slope_scaled(f, turning);
}
template <typename N>
SWAGE_INLINE const Columns<N>& turned_by(const Columns<N>& stress, const Columns<N>&, double) {
    return stress;
}
template <typename N>
SWAGE_INLINE Columns<Dual<N>> turned_by(const Columns<Dual<N>>& stress, const Columns<Dual<N>>& f,
                                        double turning) {
    return turning_scaled(stress, f, turning);
}

// Stress at gradient f. Numbers with a slope: of what turning does to the stress, theirs gets the
// share `turning`.
template <typename N>
SWAGE_INLINE void find_stress(const Phase<N>& m, const Columns<N>& f, PhaseState<N>& s,
                              double turning = 1) {
    if (knows_inside(m.kind)) {
        s.stress = m.kind == CellKind::foam ? foam_stress(*m.law, f) : rubber_stress(*m.law, f);
        s.stress = turned_by(s.stress, f, turning);
        s.mode_stress = mode_stress(*m.law, s.modes);
        return;
    }
    const Symmetric<N> a = taken_back(m.history);
    const Columns<N> elastic = f * a;
    const CellStrain<N> e = cell_strain(elastic);
    s.flowed = flow_cell(*m.law, m.history, e.log, s.modes, m.fill);
    if (m.kind == CellKind::elastic) s.flowed.kept = s.flowed.kept_modes = N{} + 1.0;
    s.stress = turned_by(elastic, turning) * cell_stress(*m.law, e, s.flowed.kept) * a;
    s.mode_stress = s.flowed.kept_modes * s.flowed.mode_stress;
}

// The guard of laws/layer_guard.h, of a material whose gradient is `gradient` without the jump.
template <typename N>
SWAGE_INLINE LayerGuard<N> layer_guard(const Phase<N>& m, const Columns<N>& f,
                                       const Columns<N>& gradient) {
    const double whole = guarded_volume(m.kind, *m.law);
    const N volume = dot(f.x, cross(f.y, f.z)), none = 0.0 * volume;
    if (!any_below(volume, whole)) return {none, none, none};
    const LayerGuard<N> g =
        guard_layer(whole, volume, dot(gradient.x, cross(gradient.y, gradient.z)));
    const double modulus = m.law->bulk + 4.0 / 3 * m.law->shear;
    return {modulus * g.energy, modulus * g.slope, modulus * g.whole_slope};
}
// Stress of a part of the cell, whose gradient is s.gradient without the jump.
template <typename N>
SWAGE_INLINE void find_part_stress(const Phase<N>& m, const Columns<N>& f, PhaseState<N>& s,
                                   double turning = 1) {
    find_stress(m, f, s, turning);
    const LayerGuard<N> guard = layer_guard(m, f, s.gradient);
    const auto push = [&](const N& by, const Columns<N>& at) __attribute__((always_inline)) {
        return turned_by(
            Columns<N>{by * cross(at.y, at.z), by * cross(at.z, at.x), by * cross(at.x, at.y)}, at,
            turning);
    };
    const Columns<N> own = push(guard.slope, f);
    s.stress = {s.stress.x + own.x, s.stress.y + own.y, s.stress.z + own.z};
    s.whole_stress = push(guard.whole_slope, s.gradient);
}

template <typename N>
struct Laminate {
    PhaseState<N> phase[2];
    Triple<N> jump;      // a
    Columns<N> inverse;  // about what undoes the tractions' difference
    N wrong, right;      // of that difference, squared: what is left of it, and what may be
    int rounds;
};

// The jump by the axes of the cell as it was molded, which a turn of the cell does not change.
template <typename N>
SWAGE_INLINE Triple<N> jump_in_cell(const Laminate<N>& r) {
    return inverse_of(r.phase[0].gradient) * r.jump;
}

// F(c_m), without the product terms of laws/cell.h: of the two parts of a full cell these do not
// add up to nothing, and a uniform strain would push.
template <typename N>
SWAGE_INLINE Columns<N> phase_gradient(const CornerSums<N>& c, const Triple<N>& at,
                                       double spacing) {
    const double s = 0.25 / spacing;
    return {s * (c.x + at.y * c.xy + at.z * c.zx), s * (c.y + at.x * c.xy + at.z * c.yz),
            s * (c.z + at.y * c.yz + at.x * c.zx)};
}

template <typename N>
SWAGE_INLINE Phase<Dual<N>> constant(const Phase<N>& m) {
    return {m.law, m.kind, constant(m.fill), constant(m.at), constant(m.history)};
}

// What a change of a by each of the axes does to the traction P n at gradient f + a n^T.
template <typename N>
SWAGE_INLINE Columns<N> traction_slope(const Phase<N>& m, const Columns<N>& f,
                                       const PhaseState<N>& at, const Triple<N>& n,
                                       double turning) {
    const Phase<Dual<N>> phase = constant(m);
    Columns<N> slope{};
    for (int axis = 0; axis < 3; ++axis) {
        const N none{}, one = none + 1.0;
        const Triple<N> e = {axis == 0 ? one : none, axis == 1 ? one : none,
                             axis == 2 ? one : none};
        PhaseState<Dual<N>> s;
        s.modes = constant(at.modes);
        s.gradient = {constant(at.gradient.x), constant(at.gradient.y), constant(at.gradient.z)};
        find_part_stress(phase, {pair(f.x, n.x * e), pair(f.y, n.y * e), pair(f.z, n.z * e)}, s,
                         turning);
        const Triple<Dual<N>> t = s.stress * constant(n);
        (axis == 0 ? slope.x : axis == 1 ? slope.y : slope.z) = {t.x.slope, t.y.slope, t.z.slope};
    }
    return slope;
}

template <typename M, typename N>
SWAGE_INLINE Triple<N> pick(const M& which, const Triple<N>& a, const Triple<N>& b) {
    return {which ? a.x : b.x, which ? a.y : b.y, which ? a.z : b.z};
}

inline constexpr int kMostRounds = 40;
inline constexpr int kGuessedRounds = 1;        // with that of small strains, where any may flow
inline constexpr int kSecantRounds = 9;         // without the exact tangent
inline constexpr double kTractionLeft = 1e-11;  // of the tractions
inline constexpr double kNoise = 1e-14;         // of the stiffer material's moduli
inline constexpr double kTooFar = 0.5;          // of the slope of W, on the other side
inline constexpr double kLongest = 0.3;         // of a step of a
inline constexpr double kFirm = 1e-7;           // of the stiffness, where flow leaves none

// The gradient's part in the jump, of each material.
template <typename N>
SWAGE_INLINE void jump_shares(const Phase<N> (&m)[2], N (&share)[2]) {
    const N all = m[0].fill + m[1].fill;
    share[0] = m[1].fill / all, share[1] = -1.0 * m[0].fill / all;
}
template <typename N>
SWAGE_INLINE Columns<N> jumped(const Columns<N>& f, const Triple<N>& n, const Triple<N>& by) {
    return {f.x + n.x * by, f.y + n.y * by, f.z + n.z * by};
}

// Of the tractions' difference with a, at a.
template <typename N>
SWAGE_INLINE Columns<N> jump_slope(const Phase<N> (&m)[2], const Triple<N>& n, const Laminate<N>& r,
                                   double turning = 1) {
    N share[2];
    jump_shares(m, share);
    Columns<N> sum{};
    for (int p = 0; p < 2; ++p) {
        const Columns<N> slope = traction_slope(
            m[p], jumped(r.phase[p].gradient, n, share[p] * r.jump), r.phase[p], n, turning);
        const N weight = p == 0 ? share[0] : -1.0 * share[1];
        const N firm = (kFirm * m[p].law->shear) * weight;
        sum = {sum.x + weight * slope.x, sum.y + weight * slope.y, sum.z + weight * slope.z};
        sum.x.x = sum.x.x + firm, sum.y.y = sum.y.y + firm, sum.z.z = sum.z.z + firm;
    }
    return sum;
}

// The same for small strains, from what flows now.
template <typename N>
SWAGE_INLINE Columns<N> about_jump_slope(const Phase<N> (&m)[2], const Triple<N>& n,
                                         const Laminate<N>& r, const N (&share)[2]) {
    Columns<N> sum{};
    for (int p = 0; p < 2; ++p) {
        const CellModuli& law = *m[p].law;
        const Columns<N> f = jumped(r.phase[p].gradient, n, share[p] * r.jump);
        const N none{}, one = none + 1.0;
        N kept = one, flows = none;
        const Symmetric<N> a = taken_back(m[p].history);
        const Columns<N> elastic = f * a;
        const Triple<N> inside = a * n, along = elastic * inside;
        Triple<N> across{};
        if (m[p].kind == CellKind::yielding) {
            const CellFlowed<N>& s = r.phase[p].flowed;
            kept = s.kept;
            const N stress = s.over + s.line.stress + s.line.slope * m[p].history.alpha;
            const N share_left = kept - (1.0 - 3 * law.shear / (3 * law.shear + s.line.slope));
            flows = s.over > none
                        ? (12 * law.shear * law.shear * law.shear) * share_left / (stress * stress)
                        : none;
            const Symmetric<N>& d = s.distortion;
            across = elastic * (d * inside);
        }
        const N weight = p == 0 ? share[0] : -1.0 * share[1];
        const N size = dot(inside, inside);
        const N shear = size * weight * larger(law.shear * kept, kFirm * law.shear + none);
        const N rise =
            (size * weight * law.bulk + (1.0 / 3) * shear) / (dot(along, along) + 1e-300);
        const N less = weight * flows;
        sum = {sum.x + (rise * along.x) * along - (less * across.x) * across,
               sum.y + (rise * along.y) * along - (less * across.y) * across,
               sum.z + (rise * along.z) * along - (less * across.z) * across};
        sum.x.x = sum.x.x + shear, sum.y.y = sum.y.y + shear, sum.z.z = sum.z.z + shear;
    }
    return sum;
}

template <typename M, typename N>
SWAGE_INLINE Columns<N> pick(const M& which, const Columns<N>& a, const Columns<N>& b) {
    return {pick(which, a.x, b.x), pick(which, a.y, b.y), pick(which, a.z, b.z)};
}

// `start`: the jump that the search begins with, as jump_in_cell() has it. It is committed as what
// has flowed is: far past yield W has more than one minimum, and whoever seeks the one that pushes
// begins there. What is elastic begins with none: its forces are those of its strain alone.
template <typename N>
SWAGE_INLINE void laminate(const CornerSums<N>& c, const Phase<N> (&m)[2], const Triple<N>& n,
                           double spacing, Laminate<N>& r, const Triple<N>& start = Triple<N>{}) {
    for (int p = 0; p < 2; ++p) {
        r.phase[p].gradient = phase_gradient(c, m[p].at, spacing);
        r.phase[p].modes = pulled_back(r.phase[p].gradient * taken_back(m[p].history), c);
    }
    N share[2];
    jump_shares(m, share);
    // Inverse of the acoustic tensor of small strains, sum of mu (1 + v v^T) with v along the
    // normal as the cell has turned it.
    N shear{}, along{};
    for (int p = 0; p < 2; ++p) {
        const double mu = m[p].law->shear, rise = m[p].law->bulk + mu / 3;
        const N weight = p == 0 ? share[0] : -1.0 * share[1];
        shear = shear + mu * weight;
        along = along + rise * weight;
    }
    const Triple<N> turned = r.phase[0].gradient * n;
    const N over = 1.0 / (dot(turned, turned) + 1e-300);
    const N one = 1.0 / shear, less = along / (shear * (shear + along)) * over;
    Columns<N> firm = {(-1.0 * less * turned.x) * turned, (-1.0 * less * turned.y) * turned,
                       (-1.0 * less * turned.z) * turned};
    firm.x.x = firm.x.x + one;
    firm.y.y = firm.y.y + one;
    firm.z.z = firm.z.z + one;

    const double noise =
        kNoise * larger(m[0].law->shear + m[0].law->bulk, m[1].law->shear + m[1].law->bulk);
    const bool flows = m[0].kind == CellKind::yielding || m[1].kind == CellKind::yielding;
    const N none{};
    const Triple<N> nowhere{};
    r.inverse = firm;
    r.jump = r.phase[0].gradient * start;
    // The step on trial begins there, with that difference.
    Triple<N> from = r.jump, way{}, last{};
    N steep{}, length = none + 1.0;  // slope of W along it; share of it that is on trial
    for (r.rounds = 0;; ++r.rounds) {
        Triple<N> pull[2];
        for (int p = 0; p < 2; ++p) {
            find_part_stress(m[p], jumped(r.phase[p].gradient, n, share[p] * r.jump), r.phase[p]);
            pull[p] = r.phase[p].stress * n;
        }
        const Triple<N> left = pull[0] - pull[1];
        const N size = dot(pull[0], pull[0]) + dot(pull[1], pull[1]);
        r.wrong = dot(left, left);
        r.right = kTractionLeft * kTractionLeft * size + noise * noise;
        const auto arrived = r.wrong < r.right;
        if (r.rounds == kMostRounds || are_all(arrived)) return;
        const N now = dot(left, way);
        const auto good = arrived | (now <= -kTooFar * steep);
        Columns<N> inverse = r.inverse;
        if (flows && r.rounds < kGuessedRounds) {
            inverse = inverse_of(about_jump_slope(m, n, r, share));
        } else if (r.rounds < kSecantRounds) {
            // The step was meant to bring the difference to nothing; what it did corrects.
            const Triple<N> step = r.jump - from, gone = inverse * (left - last);
            const Triple<N> row = {dot(step, inverse.x), dot(step, inverse.y),
                                   dot(step, inverse.z)};
            const N scale = dot(step, gone), enough = 0.1 * dot(step, step);
            const Triple<N> missed =
                pick(scale > enough, (1.0 / (scale + 1e-300)) * (step - gone), nowhere);
            inverse = {inverse.x + row.x * missed, inverse.y + row.y * missed,
                       inverse.z + row.z * missed};
        } else {
            inverse = inverse_of(jump_slope(m, n, r));
        }
        r.inverse = pick(arrived, r.inverse, inverse);  // lanes that have arrived stay
        Triple<N> next = -1.0 * (r.inverse * left);
        next = pick(dot(left, next) < none, next, -1.0 * (firm * left));
        const N far = root(dot(next, next));
        next = pick(far > kLongest + none, (kLongest / (far + 1e-300)) * next, next);
        next = pick(arrived, nowhere, next);
        const N cut = steep / (steep - now), least = none + 0.1, most = none + 0.7;
        const N shorter = cut > least ? (cut < most ? cut : most) : least;
        from = pick(good, r.jump, from);
        last = pick(good, left, last);
        way = pick(good, next, way);
        steep = good ? dot(left, next) : steep;
        length = good ? none + 1.0 : length * shorter;
        r.jump = from + length * way;
    }
}

// Forces on the sums of the corners.
template <typename N>
SWAGE_INLINE CornerSums<N> laminate_forces(const CornerSums<N>& c, const Phase<N> (&m)[2],
                                           const Laminate<N>& r, double spacing) {
    const double volume = spacing * spacing * spacing;
    const auto of = [&](int p) __attribute__((always_inline)) {
        const PhaseState<N>& s = r.phase[p];
        const Triple<N>& at = m[p].at;
        const N scale = volume * m[p].fill;
        const Triple<N> centre{};
        const Symmetric<N> a = taken_back(m[p].history);
        const Columns<N> push = {scale * (s.stress.x + s.whole_stress.x),
                                 scale * (s.stress.y + s.whole_stress.y),
                                 scale * (s.stress.z + s.whole_stress.z)};
        CornerSums<N> f = sum_forces(c, s.gradient * a, a, push,
                                     mode_fill(m[p].fill) * s.mode_stress, centre, spacing);
        f.xy = f.xy + at.y * f.x + at.x * f.y;
        f.yz = f.yz + at.z * f.y + at.y * f.z;
        f.zx = f.zx + at.z * f.x + at.x * f.z;
        return f;
    };
    const CornerSums<N> a = of(0), b = of(1);
    return {a.x + b.x, a.y + b.y, a.z + b.z, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx, a.xyz + b.xyz};
}

// How the forces change with the sums going some way, the jump following: `inverse` of
// jump_slope(), both with the same share of what turning does.
template <typename N>
SWAGE_INLINE CornerSums<N> laminate_slope(const CornerSums<N>& c, const CornerSums<N>& way,
                                          const Phase<N> (&m)[2], const Triple<N>& n,
                                          double spacing, const Triple<N>& jump,
                                          const Columns<N>& inverse, double turning) {
    using D = Dual<N>;
    const CornerSums<D> x = pair(c, way);
    const Phase<D> phase[2] = {constant(m[0]), constant(m[1])};
    const Triple<D> normal = constant(n);
    D share[2];
    jump_shares(phase, share);
    Laminate<D> r;
    r.jump = constant(jump);
    for (int round = 0; round < 2; ++round) {
        Triple<D> left{};
        for (int p = 0; p < 2; ++p) {
            PhaseState<D>& s = r.phase[p];
            s.gradient = phase_gradient(x, phase[p].at, spacing);
            s.modes = pulled_back(s.gradient * taken_back(phase[p].history), x);
            find_part_stress(phase[p], jumped(s.gradient, normal, share[p] * r.jump), s, turning);
            const Triple<D> pull = s.stress * normal;
            left = p == 0 ? pull : left - pull;
            s.gradient = slope_scaled(s.gradient, turning);
        }
        if (round > 0) break;
        // The first time the jump has stayed.
        const Triple<N> follows =
            -1.0 * (inverse * Triple<N>{left.x.slope, left.y.slope, left.z.slope});
        r.jump = pair(jump, follows);
    }
    const CornerSums<D> f = laminate_forces(slope_scaled(x, turning), phase, r, spacing);
    const auto slope = [](const Triple<D>& t) __attribute__((always_inline)) {
        return Triple<N>{t.x.slope, t.y.slope, t.z.slope};
    };
    return {slope(f.x),  slope(f.y),  slope(f.z),  slope(f.xy),
            slope(f.yz), slope(f.zx), slope(f.xyz)};
}

}  // namespace swage
