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
//                                            of 1 after all n_b.N n_b with tr N = 0 are taken out
//                                            of it, and t = <e, i> / <i, i>
//     s_b = e_b - t i_b                      what is left is distortion; N the closest to it
//     S = <s, s>,  S_0 = 2 |N|^2 + what of S is not N, by the mean of w / c
//     q = mu S sqrt(3 / S_0)                 equivalent stress [Pa]: of the stress, what works
//     q > sigma(alpha):                      p_b += phi (s_b - theta + t),  theta = ln(det F) / 3,
//                                            alpha += phi sqrt(S_0 / 3), by the phi that leaves
//                                            q = sigma(alpha)
//
// p_b is the plastic strain that the cell gives the connection, alpha the accumulated plastic
// strain; a connection's rest_length follows the mean of its cells. <e, s> = S is never negative,
// so flow takes energy, however far matter has flowed and whatever its connections mean by then;
// N has no trace, so it keeps the volume, and theta - t, of second order in a step, brings back
// what was lost of it. Of a cell as it was molded S_0 = S = 2 |dev eps|^2, the same in every
// direction.
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
// The history (p_b, alpha) has a committed value; every evaluation returns from it, leaving no
// trace.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "laws/flow_curve.h"
#include "laws/lane_power.h"

namespace swage {

inline constexpr double kEdgeShare = 0.25;  // w
inline constexpr double kDiagonalShare = 1.0;
inline constexpr double kAllShares = 12 * (kEdgeShare + kDiagonalShare);
inline constexpr double kRootOfShares = 3.8729833462074169;  // of kAllShares
inline constexpr double kRoot3 = 1.7320508075688772;

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

template <typename N>
using SpringsOf = std::array<N, 24>;  // a number of each connection
using Springs = SpringsOf<double>;

// Of numbers N: bool of a double, one a lane of a batch.
template <typename N>
using MaskOf = std::remove_cvref_t<decltype(std::declval<N>() < std::declval<N>())>;
SWAGE_INLINE bool is_any(bool mask) { return mask; }
template <LaneVector M>
SWAGE_INLINE bool is_any(const M& mask) {
    bool any = false;
    for (int l = 0; l < kWidthOf<M>; ++l) any = any || mask[l] != 0;
    return any;
}
template <typename N>
SWAGE_INLINE N smaller(const N& a, const N& b) {
    return a < b ? a : b;
}
SWAGE_INLINE double power_of_e(double y) { return lane_power::power_of_e<long long>(y); }
template <LaneVector V>
SWAGE_INLINE V power_of_e(const V& y) {
    return lane_power::power_of_e<typename LaneBatch<kWidthOf<V>>::Indices, V>(y);
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

template <typename N>
struct CellSprings {
    std::array<Triple<N>, 24> way;  // d n_b, over its reference_length
    SpringsOf<N> strain;            // e_b
};

// A symmetric tensor without trace by what it is along n: of (xx - yy, xx + yy - 2 zz, xy, yz, zx)
// that n.N n is made of.
template <typename N>
using Traceless = std::array<N, 5>;
template <typename N>
SWAGE_INLINE N product(const Traceless<N>& a, const Traceless<N>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4];
}
// Of the tensors themselves, N : M.
template <typename N>
SWAGE_INLINE N contract(const Traceless<N>& a, const Traceless<N>& b) {
    return 2.0 * a[0] * b[0] + 6.0 * a[1] * b[1] + 0.5 * (a[2] * b[2] + a[3] * b[3] + a[4] * b[4]);
}

// L D L^T of five equations, by the lower half of their matrix.
template <typename N>
struct FiveEquations {
    N lower[5][5], over[5];

    SWAGE_INLINE void take(const N (&m)[5][5], const N& least) {
        N part[5][5];  // L D
        for (int j = 0; j < 5; ++j) {
            for (int i = j; i < 5; ++i) {
                part[i][j] = m[i][j];
                for (int k = 0; k < j; ++k) part[i][j] -= part[i][k] * lower[j][k];
            }
            over[j] = 1.0 / larger(part[j][j], least);
            for (int i = j + 1; i < 5; ++i) lower[i][j] = part[i][j] * over[j];
        }
    }
    SWAGE_INLINE Traceless<N> solve(Traceless<N> v) const {
        for (int i = 1; i < 5; ++i) {
            for (int k = 0; k < i; ++k) v[i] -= lower[i][k] * v[k];
        }
        for (int i = 0; i < 5; ++i) v[i] = v[i] * over[i];
        for (int i = 3; i >= 0; --i) {
            for (int k = i + 1; k < 5; ++k) v[i] -= lower[k][i] * v[k];
        }
        return v;
    }
};

template <typename N>
struct SpringDistortion {
    N worked, meant;  // S, S_0

    SWAGE_INLINE N stress(double shear) const {  // q
        return meant > 0.0 ? shear * worked * root(3.0 / meant) : N{};
    }
};

// A connection as it lies.
template <typename N>
struct SpringWay {
    Triple<N> way;
    N weight, over;  // c_b, 1 / d^2
};

// A cell as its connections lie, for strains of these.
template <typename N>
class SpringFrame {
  public:
    // `connection(b)` gives its SpringWay.
    template <typename Of>
    SWAGE_INLINE explicit SpringFrame(const Of& connection) {
        N m[5][5]{};
        for (std::size_t b = 0; b < weight_.size(); ++b) {
            const SpringWay<N> c = connection(b);
            const Triple<N> r = c.over * c.way;
            Traceless<N>& along = along_[b];
            along[0] = r.x * c.way.x - r.y * c.way.y;
            along[1] = 1.0 - 3.0 * (r.z * c.way.z);
            along[2] = r.x * c.way.y, along[3] = r.y * c.way.z, along[4] = r.z * c.way.x;
            weight_[b] = c.weight;
            for (int i = 0; i < 5; ++i) {
                const N part = c.weight * along[i];
                for (int j = 0; j <= i; ++j) m[i][j] += part * along[j];
                of_one_[i] += part;
            }
            one_one_ += c.weight;
        }
        // All in a plane: what none of them can tell is not theirs.
        for (int i = 0; i < 5; ++i) m[i][i] += 1e-12 * one_one_;
        equations_.take(m, 1e-13 * one_one_);
        size_ = equations_.solve(of_one_);
        pressed_ = larger(one_one_ - product(of_one_, size_), 1e-12 * one_one_);
        over_pressed_ = 1.0 / pressed_, spread_ = kAllShares / one_one_;
    }

    // Of strains: their parts along n_b.N n_b, and N; their sum; each linear in them.
    struct Sums {
        Traceless<N> along, mean;
        N one;
    };
    SWAGE_INLINE Sums sums(const SpringsOf<N>& strain) const {
        Sums s{};
        for (std::size_t b = 0; b < strain.size(); ++b) {
            const N part = weight_[b] * strain[b];
            for (int i = 0; i < 5; ++i) s.along[i] += part * along_[b][i];
            s.one += part;
        }
        s.mean = equations_.solve(s.along);
        return s;
    }
    SWAGE_INLINE N product_of(const SpringsOf<N>& u, const SpringsOf<N>& v) const {
        N sum{};
        for (std::size_t b = 0; b < u.size(); ++b) sum += weight_[b] * u[b] * v[b];
        return sum;
    }
    SWAGE_INLINE N pressed(const Sums& strain) const {  // t
        return (strain.one - product(strain.along, size_)) * over_pressed_;
    }
    // `square`: <e, e>; `along`: of e less what is not along any n_b.N n_b; `mean`: N : N.
    SWAGE_INLINE SpringDistortion<N> distortion(const N& t, const N& square, const N& along,
                                                const N& mean) const {
        const N worked = larger(square - t * t * pressed_, N{});
        return {worked, 2.0 * mean + spread_ * (worked - smaller(along, worked))};
    }
    SWAGE_INLINE SpringDistortion<N> distortion(const SpringsOf<N>& strain) const {
        const Sums s = sums(strain);
        return distortion(pressed(s), product_of(strain, strain), product(s.along, s.mean),
                          contract(s.mean, s.mean));
    }
    SWAGE_INLINE N pressure_strain(std::size_t b) const {  // i_b
        return 1.0 - product(along_[b], size_);
    }
    SWAGE_INLINE N weight(std::size_t b) const { return weight_[b]; }
    SWAGE_INLINE N weight() const { return one_one_; }
    SWAGE_INLINE N pressure() const { return pressed_; }  // <i, i>
    SWAGE_INLINE N spread() const { return spread_; }     // the mean of w / c

    // The strain of the cell as a whole.
    SWAGE_INLINE Symmetric<N> mean_strain(const Sums& strain) const {
        const N t = pressed(strain);
        Traceless<N> dev;
        for (int i = 0; i < 5; ++i) dev[i] = strain.mean[i] - t * size_[i];
        return {t + dev[1] + dev[0], t + dev[1] - dev[0], t - 2.0 * dev[1],
                0.5 * dev[2],        0.5 * dev[3],        0.5 * dev[4]};
    }

  private:
    SpringsOf<N> weight_;  // c_b
    std::array<Traceless<N>, 24> along_;
    Traceless<N> of_one_{}, size_;
    FiveEquations<N> equations_;
    N one_one_{}, pressed_, over_pressed_, spread_;
};

template <typename N>
SWAGE_INLINE SpringFrame<N> frame_of(const CellSprings<N>& cell, const Springs& share) {
    return SpringFrame<N>([&](std::size_t b) __attribute__((always_inline)) {
        const N square = larger(dot(cell.way[b], cell.way[b]), 1e-300 + N{});
        return SpringWay<N>{cell.way[b], share[b] * square, 1.0 / square};
    });
}
// Halfway between rest, where `cell.strain` is none, and now. Along n_b, (1 - exp(-2 e)) / 2 is
// n_b.A n_b of one A = (1 - exp(-2 H)) / 2 wherever a cell is strained alike, by H, however far.
template <typename N>
SWAGE_INLINE SpringFrame<N> halfway(const SpringFrame<N>& now, const CellSprings<N>& cell) {
    SpringsOf<N> almansi;
    for (std::size_t b = 0; b < almansi.size(); ++b) {
        const N e = smaller(larger(cell.strain[b], -0.5 + N{}), 0.5 + N{});
        almansi[b] = e - e * e * (1.0 - (2.0 / 3) * e);
    }
    const Symmetric<N> a = now.mean_strain(now.sums(almansi));
    const Symmetric<N> squared = square(a);
    const Symmetric<N> half =  // exp(-H/2)
        plus_unit(-0.5 * a - 0.375 * squared - 0.4375 * commuting(a, squared), 1.0);
    return SpringFrame<N>([&](std::size_t b) __attribute__((always_inline)) {
        const Triple<N> way = half * cell.way[b];
        const N e = 0.5 * smaller<N>(larger(cell.strain[b], -1.0 + N{}), 1.0 + N{});
        const N square = larger(dot(way, way), 1e-300 + N{}), longer = 1.0 + e;
        const N over = 1.0 / (square * longer);
        // exp(-2 e) = (1 - e) / (1 + e)
        return SpringWay<N>{way, now.weight(b) * (1.0 - e) * square * over, longer * over};
    });
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
// others grows. NOTE: what grows goes by how the cell lay halfway between rest and now, what the
// stress is by how it lies now: a step of five percent is then right to a few thousandths, and its
// end lies on the yield surface.
template <typename N>
SWAGE_INLINE MaskOf<N> return_springs(const Yield& law, const CellSprings<N>& cell,
                                      const Springs& share, const N& theta, const N& alpha,
                                      const MaskOf<N>& may, SpringReturn<N>& r) {
    const SpringFrame<N> now = frame_of(cell, share);
    const typename SpringFrame<N>::Sums sums = now.sums(cell.strain);
    const N square = now.product_of(cell.strain, cell.strain), t = now.pressed(sums);
    const N along = product(sums.along, sums.mean), mean = contract(sums.mean, sums.mean);
    const N q = now.distortion(t, square, along, mean).stress(law.shear_modulus);
    const MaskOf<N> flows = may & (q > flow_stress(law, alpha).stress);
    if (!is_any(flows)) return flows;

    const SpringFrame<N> mid = halfway(now, cell);
    const typename SpringFrame<N>::Sums of_mid = mid.sums(cell.strain);
    const N pressed = mid.pressed(of_mid);
    const SpringDistortion<N> way =
        mid.distortion(pressed, mid.product_of(cell.strain, cell.strain),
                       product(of_mid.along, of_mid.mean), contract(of_mid.mean, of_mid.mean));
    // The volume gets no more than half of the work, nor a tenth of the flow.
    const N size = larger(larger(of_mid.one, -of_mid.one), 1e-300 + N{});
    const N most = smaller<N>(0.5 * way.worked / size, 0.1 * root(way.worked / mid.weight()));
    const N lost = smaller<N>(larger(theta - pressed, -most), most);
    for (std::size_t b = 0; b < share.size(); ++b) {
        r.grows[b] = cell.strain[b] - pressed * mid.pressure_strain(b) - lost;
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
