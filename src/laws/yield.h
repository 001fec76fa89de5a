// SPDX-License-Identifier: GPL-3.0-or-later
// Plasticity after von Mises with isotropic hardening, linear or along a flow curve
// (laws/flow_curve.h), for a cell of 24 connections (12 edges, 12 face diagonals) along unit
// vectors n_b:
//
//     e_b = ln(d / reference_length) - p_b   elastic strain of a connection
//     c_b = w_b (d / reference_length)^2     w: 1/4 of edges, 1 of diagonals; mu c_b e_b is the
//                                            tension times d, for the cell's volume [Pa]
//     <u, v> = sum c_b u_b v_b
//     t i_b                                  the part of e_b that is pressure alone: i is the rest
//                                            of 1 after what does not change the volume is taken
//                                            out of it, that is n_b.N n_b of all N with tr N = 0,
//                                            and all bending and twisting within the cell;
//                                            t = <e, i> / <i, i>
//     s_b = e_b - t i_b                      what is left is distortion; N the closest to it
//     S = <s, s>,  S_0 = 2 |N|^2 + what of S is not N, by the mean of w / c
//     q = mu S sqrt(3 / S_0)                 equivalent stress [Pa]: of the stress, what works
//     q > sigma(alpha):                      p_b += phi (e_b - theta i_b),  theta = ln(det F) / 3,
//                                            alpha += phi sqrt(S_0 / 3), by the phi that leaves
//                                            q = sigma(alpha)
//
// p_b is the plastic strain that the cell gives the connection, alpha the accumulated plastic
// strain; a connection's rest_length follows the mean of its cells. <e, s> = S is never negative,
// so flow takes energy, however far matter has flowed and whatever its connections mean by then;
// s keeps the volume, and theta - t, of second order in a step, brings back what was lost of it.
// Of a cell as it was molded S_0 = S = 2 |dev eps|^2, the same in every direction.
//
// Bending and twisting within the cell count as distortion too and yield by the same factor: kept
// elastic they would carry a moment of 1.8 E I kappa / N^2 for ever (N cells across), more than the
// plastic one at large curvature.
//
// NOTE: yielding each connection by its own strain, the nearest thing to the papers, was tried
// first: tuned for tension it is half too weak in shear, it flows under pressure, and bars fold
// flat between tools. With c = w and i = 1 what is pressed works less the more it has flowed
// (pressed connections are weaker by the square of their length), and in the end makes energy.
// NOTE: without hardening a bent bar may fold in a hinge one cell wide.
//
// NOTE: where i knows nothing of bending and twisting, pressure works on these, of which theta
// knows nothing and which nothing resists that flows: cells crumple by forces that belong to no
// energy, no equilibrium is found under pressures of many times the yield stress, and balls that
// sag lose a fifth of their volume.
//
// The history (p_b, alpha) has a committed value; every evaluation returns from it, leaving no
// trace.
#pragma once

#include <cstddef>

#include "laws/flow_curve.h"
#include "laws/spring_frame.h"

namespace swage {

// ln of a ratio of lengths by its rational series; error below 1e-7 from 0.7 to 1.4, 2e-4 at 0.4
// and 2.5. One division, so that loops over it vectorise.
template <typename Number>
SWAGE_INLINE Number log_ratio(const Number& ratio) {
    const Number y = (ratio - 1.0) / (ratio + 1.0), y2 = y * y;
    return 2.0 * y * (1.0 + y2 * (1.0 / 3 + y2 * (1.0 / 5 + y2 * (1.0 / 7 + y2 * (1.0 / 9)))));
}

struct Yield {
    double yield_stress;   // sigma_y [Pa]
    double hardening;      // H [Pa]
    double shear_modulus;  // mu [Pa]
    FlowCurve curve = {};  // instead of sigma_y + H alpha where it is not empty
};

// S at which a cell that has never yielded begins to, as it was molded.
inline double yield_distortion(const Yield& law) {
    const double e = law.yield_stress / law.shear_modulus;
    return e * e / 3;
}

// sigma(alpha) and its slope, of numbers side by side.
// NOTE: kept out of the loops over cells, which the search would slow where there is no curve.
template <int kWidth>
[[gnu::noinline]] void flow_stresses(const FlowCurve& curve, const double (&alpha)[kWidth],
                                     FlowLine<double> (&flow)[kWidth]) {
    for (int l = 0; l < kWidth; ++l) {
        const FlowLine<double>& line = part_from(curve, alpha[l])->line;
        flow[l] = {line.stress + line.slope * alpha[l], line.slope};
    }
}
SWAGE_INLINE FlowLine<double> flow_at(const Yield& law, double alpha) {
    FlowLine<double> flow[1];
    flow_stresses(law.curve, {alpha}, flow);
    return flow[0];
}
template <LaneVector V>
SWAGE_INLINE FlowLine<V> flow_at(const Yield& law, const V& alpha) {
    double at[kWidthOf<V>];
    FlowLine<double> flow[kWidthOf<V>];
    for (int l = 0; l < kWidthOf<V>; ++l) at[l] = alpha[l];
    flow_stresses(law.curve, at, flow);
    FlowLine<V> all;
    for (int l = 0; l < kWidthOf<V>; ++l)
        all.stress[l] = flow[l].stress, all.slope[l] = flow[l].slope;
    return all;
}
// sigma at alpha, and its slope there.
template <typename N>
SWAGE_INLINE FlowLine<N> flow_stress(const Yield& law, const N& alpha) {
    if (!law.curve.empty()) [[unlikely]]
        return flow_at(law, alpha);
    return {law.yield_stress + law.hardening * alpha, law.hardening + N{}};
}

// At least q / mu of a cell, from what is soon found: the sum of w (e_b - theta)^2, and the least
// and most of ln(d / reference_length). S is no more than <e - x, e - x> with any x that is
// pressure alone, c no more than w r^2 of the longest's ratio r, S / S_0 than that r^2, and i is no
// farther from 1 than the cell from a cube.
template <typename N>
SWAGE_INLINE N most_stress(const N& distortion, const N& theta, const N& shortest,
                           const N& longest) {
    const N off_cube = smaller<N>(1.0 + N{}, 2.0 * (power_of_e(2.0 * (longest - shortest)) - 1.0));
    const N size = larger(theta, -theta);
    return kRoot3 * power_of_e(2.0 * longest) *
           (root(distortion) + size * kRootOfShares * off_cube);
}

// a - b x + c x^2
template <typename N>
struct Parabola {
    N a, b, c;
    SWAGE_INLINE N at(const N& x) const { return a - x * (b - x * c); }
    SWAGE_INLINE N slope(const N& x) const { return 2.0 * (x * c) - b; }
};
// q after a part of what may flow has: what it is made of goes by the square of that part.
template <typename N>
struct StressLeft {
    double shear;
    N spread;
    Parabola<N> worked, along, mean;

    struct Value {
        N value, slope;
    };
    SWAGE_INLINE Value at(const N& part) const {
        const N off = worked.at(part), beside = along.at(part), s = larger(off, N{});
        const MaskOf<N> is_less = beside < s;
        const N meant = 2.0 * mean.at(part) + (is_less ? spread * (s - beside) : N{});
        const N s_slope = off > 0.0 ? worked.slope(part) : N{};
        const N meant_slope =
            2.0 * mean.slope(part) + (is_less ? spread * (s_slope - along.slope(part)) : N{});
        const N over = 1.0 / larger(meant, 1e-300 + N{}), r = shear * root(3.0 * over);
        return {r * s, r * (s_slope - 0.5 * (s * meant_slope * over))};
    }
};
// That leaves q = sigma; all of it where that is still too much. By Newton's method within what is
// known to be too little and too much; `sought`: others are not looked for.
template <typename N>
SWAGE_INLINE N part_that_flows(const Yield& law, const StressLeft<N>& left, const N& alpha,
                               const N& per_share, const MaskOf<N>& sought) {
    constexpr int kTries = 60;
    constexpr double kError = 1e-12;  // of the stress
    // From here on a step is right to that, where no line ends.
    const double near = law.curve.empty() ? 1e-6 : kError;
    N low{}, high = 1.0 + N{}, part{}, first{};
    MaskOf<N> open = sought;
    for (int n = 0; n < kTries; ++n) {
        const auto stress = left.at(part);
        const FlowLine<N> flow = flow_stress(law, alpha + part * per_share);
        const N off = stress.value - flow.stress, slope = stress.slope - flow.slope * per_share;
        if (n == 0) first = stress.value;
        const MaskOf<N> little = off > 0.0;
        open = open & !(little & (part >= 1.0));
        low = little ? part : low, high = little ? high : part;
        const N newton = part - off / slope;
        const MaskOf<N> holds = (newton > low) & (newton < high);
        const N halved = (newton >= high) & (high >= 1.0) ? 1.0 + N{} : 0.5 * (low + high);
        const MaskOf<N> is_near = larger(off, -off) < near * first;
        part = open ? (holds ? newton : is_near ? part : halved) : part;
        open = open & !is_near;
        if (!is_any(open)) break;
    }
    return part;
}

template <typename N>
struct SpringReturn {
    N d_alpha{};
    SpringsOf<N> grows{};  // of p_b
};

// `theta`: of what the cell is large by. Returns which flow, of those that `may`; nothing of the
// others grows. NOTE: alpha grows by how the cell lay halfway between rest and now, what is left is
// pressure by how it lies now: a step of five percent is then right to a few thousandths, and its
// end lies on the yield surface.
template <typename N>
SWAGE_INLINE MaskOf<N> return_springs(const Yield& law, const CellSprings<N>& cell,
                                      const SpringLayout& layout, const N& theta, const N& alpha,
                                      const MaskOf<N>& may, SpringReturn<N>& r) {
    const SpringFrame<N> now = frame_of(cell, layout);
    const typename SpringFrame<N>::Sums sums = now.sums(cell.strain);
    const N square = now.product_of(cell.strain, cell.strain), t = now.pressed(sums);
    const N along = product(sums.along, sums.mean), mean = contract(sums.mean, sums.mean);
    const N q = now.distortion(t, square, along, mean).stress(law.shear_modulus);
    const MaskOf<N> flows = may & (q > flow_stress(law, alpha).stress);
    if (!is_any(flows)) return flows;

    const SpringFrame<N, 0> mid = halfway(now, cell, layout);
    const typename SpringFrame<N, 0>::Sums of_mid = mid.sums(cell.strain);
    const SpringDistortion<N> way =
        mid.distortion(mid.pressed(of_mid), mid.product_of(cell.strain, cell.strain),
                       product(of_mid.along, of_mid.mean), contract(of_mid.mean, of_mid.mean));
    // What is left is pressure by the volume, for which no more than half of what works is taken.
    const N worked = larger(square - now.pressure() * (t * t), N{});
    const N most = root(t * t + 0.5 * worked / now.pressure());
    const N left_as = smaller<N>(larger(theta, -most), most);
    for (std::size_t b = 0; b < r.grows.size(); ++b) {
        r.grows[b] = cell.strain[b] - left_as * now.pressure_strain(b);
    }

    const typename SpringFrame<N>::Sums gone = now.sums(r.grows);
    const N gone_t = now.pressed(gone), per_share = root(way.meant / 3.0);
    const StressLeft<N> left = {
        law.shear_modulus,
        now.spread(),
        {square - now.pressure() * (t * t),
         2.0 * (now.product_of(cell.strain, r.grows) - now.pressure() * (t * gone_t)),
         now.product_of(r.grows, r.grows) - now.pressure() * (gone_t * gone_t)},
        {along, 2.0 * product(sums.along, gone.mean), product(gone.along, gone.mean)},
        {mean, 2.0 * contract(sums.mean, gone.mean), contract(gone.mean, gone.mean)}};
    const N part = part_that_flows(law, left, alpha, per_share, flows);
    r.d_alpha = flows ? part * per_share : N{};
    for (N& one : r.grows) one = flows ? part * one : N{};
    return flows;
}

}  // namespace swage
