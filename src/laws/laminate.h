// SPDX-License-Identifier: GPL-3.0-or-later
// A cell that the plane boundary of two materials crosses. Each obeys its own law (laws/cell.h)
// with its own share of the cell, seen from its own centroid; across the boundary the gradient may
// jump along the normal n, by as much as lets the traction pass:
//
//     F_1 = F(c_1) + (f_2 / f) a n^T        F_2 = F(c_2) - (f_1 / f) a n^T       f = f_1 + f_2
//     W = sum of f_m V w_m(F_m) + f_m^3 W_q,m(F(c_m)^T Q)                         [J]
//     a minimises W:   (P_1 - P_2) n = 0,   P_m = dw_m/dF_m                       [Pa]
//
// so that layers in series share the stress and layers side by side the strain. By the minimum the
// forces are the gradient of W with a held. Plastic flow couples strain and modes within each
// material as in laws/cell.h.
//
// NOTE: where either material can yield there is no jump (a = 0): with flow in it the minimum was
// not found in one cell of twenty, which kept whole bodies from coming to rest. In series such
// cells are too stiff, by f_soft a / L of the strain over a soft length L at most.
//
// Source of the jump: rank-one laminates, e.g. G. Milton, "The theory of composites", 2002, ch. 9.
// a is found by Broyden's method from the laminate of small strains (C. Broyden, "A class of
// methods for solving nonlinear simultaneous equations", Math. Comp. 19, 1965).
#pragma once

#include "laws/cell_forces.h"

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
    CellModes<N> modes;        // F(c_m)^T Q
    Columns<N> stress;         // P_m [Pa]
    CellModes<N> mode_stress;  // dW_q/dq of a whole cell
    CellFlowed<N> flowed;      // of what yields
};

// Stress at gradient f.
template <typename N>
SWAGE_INLINE void find_stress(const Phase<N>& m, const Columns<N>& f, PhaseState<N>& s) {
    if (m.kind == CellKind::rubber) {
        s.stress = rubber_stress(*m.law, f);
        s.mode_stress = mode_stress(*m.law, s.modes);
        return;
    }
    const CellStrain<N> e = cell_strain(f);
    s.flowed = flow_cell(*m.law, m.history, e.log, s.modes, m.fill);
    if (m.kind == CellKind::elastic) s.flowed.kept = N{} + 1.0;
    const N pressure = m.law->bulk * s.flowed.trace;
    Symmetric<N> t = ((2 * m.law->shear) * s.flowed.kept) * s.flowed.distortion;
    t.xx = t.xx + pressure, t.yy = t.yy + pressure, t.zz = t.zz + pressure;
    s.stress = f * material_stress(e, t);
    s.mode_stress = s.flowed.kept * s.flowed.mode_stress;
}

template <typename N>
struct Laminate {
    PhaseState<N> phase[2];
    Triple<N> jump;  // a
    int rounds;
};

// F(c_m), without the product terms of laws/cell.h: of the two parts of a full cell these do not
// add up to nothing, and a uniform strain would push.
template <typename N>
SWAGE_INLINE Columns<N> phase_gradient(const CornerSums<N>& c, const Triple<N>& at,
                                       double spacing) {
    const double s = 0.25 / spacing;
    return {s * (c.x + at.y * c.xy + at.z * c.zx), s * (c.y + at.x * c.xy + at.z * c.yz),
            s * (c.z + at.y * c.yz + at.x * c.zx)};
}

SWAGE_INLINE bool all_less(double a, double b) { return a < b; }
template <LaneVector V>
SWAGE_INLINE bool all_less(const V& a, const V& b) {
    bool all = true;
    for (std::size_t l = 0; l < sizeof(V) / sizeof(double); ++l) all = all && a[l] < b[l];
    return all;
}

inline constexpr int kMostRounds = 40;
inline constexpr double kTractionLeft = 1e-11;  // of the tractions
inline constexpr double kNoise = 1e-14;         // of the stiffer material's moduli

template <typename N>
SWAGE_INLINE void laminate(const CornerSums<N>& c, const Phase<N> (&m)[2], const Triple<N>& n,
                           double spacing, Laminate<N>& r) {
    for (int p = 0; p < 2; ++p) {
        r.phase[p].gradient = phase_gradient(c, m[p].at, spacing);
        r.phase[p].modes = pulled_back(r.phase[p].gradient, c);
    }
    const N all = m[0].fill + m[1].fill;
    const N share[2] = {m[1].fill / all, -1.0 * m[0].fill / all};
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
    Columns<N> inverse = {(-1.0 * less * turned.x) * turned, (-1.0 * less * turned.y) * turned,
                          (-1.0 * less * turned.z) * turned};
    inverse.x.x = inverse.x.x + one;
    inverse.y.y = inverse.y.y + one;
    inverse.z.z = inverse.z.z + one;

    const double noise =
        kNoise * larger(m[0].law->shear + m[0].law->bulk, m[1].law->shear + m[1].law->bulk);
    const bool flows = m[0].kind == CellKind::yielding || m[1].kind == CellKind::yielding;
    r.jump = {N{}, N{}, N{}};
    Triple<N> step{}, last{};
    for (r.rounds = 0;; ++r.rounds) {
        Triple<N> pull[2];
        for (int p = 0; p < 2; ++p) {
            const Triple<N> by = share[p] * r.jump;
            const Columns<N>& f = r.phase[p].gradient;
            find_stress(m[p], Columns<N>{f.x + n.x * by, f.y + n.y * by, f.z + n.z * by},
                        r.phase[p]);
            pull[p] = r.phase[p].stress * n;
        }
        const Triple<N> left = pull[0] - pull[1];
        const N size = dot(pull[0], pull[0]) + dot(pull[1], pull[1]);
        const N wrong = dot(left, left),
                right = kTractionLeft * kTractionLeft * size + noise * noise;
        if (flows || r.rounds == kMostRounds || all_less(wrong, right)) return;
        if (r.rounds > 0) {
            // The step was meant to bring the difference to nothing; what it did corrects.
            const Triple<N> gone = inverse * (left - last);
            const Triple<N> row = {dot(step, inverse.x), dot(step, inverse.y),
                                   dot(step, inverse.z)};
            const N scale = dot(step, gone);
            const N full = dot(step, step), none{};
            const N factor = scale > 0.1 * full ? 1.0 / (scale + 1e-300) : none;
            const Triple<N> missed = factor * (step - gone);
            inverse = {inverse.x + row.x * missed, inverse.y + row.y * missed,
                       inverse.z + row.z * missed};
        }
        // Lanes that have arrived stay.
        const Triple<N> on = inverse * left;
        const N none{};
        step = {wrong < right ? none : -1.0 * on.x, wrong < right ? none : -1.0 * on.y,
                wrong < right ? none : -1.0 * on.z};
        last = left;
        r.jump = r.jump + step;
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
        CornerSums<N> f = sum_forces(
            c, s.gradient, Columns<N>{scale * s.stress.x, scale * s.stress.y, scale * s.stress.z},
            mode_fill(m[p].fill) * s.mode_stress, centre, spacing);
        f.xy = f.xy + at.y * f.x + at.x * f.y;
        f.yz = f.yz + at.z * f.y + at.y * f.z;
        f.zx = f.zx + at.z * f.x + at.x * f.z;
        return f;
    };
    const CornerSums<N> a = of(0), b = of(1);
    return {a.x + b.x, a.y + b.y, a.z + b.z, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx, a.xyz + b.xyz};
}

}  // namespace swage
