// SPDX-License-Identifier: GPL-3.0-or-later
// Kinematic hardening of a cell (laws/cell.h): of the stress at which it flows a part, the back
// stress X, has the sense of the flow, so that what has been pulled flows early when it is pressed.
// X follows Armstrong and Frederick,
//
//     X' = 2/3 C e_p' - gamma X p',   X_s = C / gamma        p = alpha
//
// and is of the shape of what flows, z = (dev E, q): X = 2 mu b, b = (B, beta), in the axes of the
// history, and so turns with the matter. By |z|^2 = dev E : dev E + f^2 W_q(q) / (mu V), of which
// sqrt(6) mu |z| is the equivalent stress, an increment d = d_alpha goes, from a trial state z,
//
//     n = (z - m b) / |z - m b|                     m = (1 - e^-x) / x,  x = gamma d
//     sqrt(6) mu n.(z - e^-x b) - 3 mu d - (1 - e^-x) X_s = R(alpha + d)
//     z <- z - sqrt(3/2) d n,   b <- e^-x b + (1 - e^-x) X_s / (sqrt(6) mu) n
//     R(p) = sigma(p) - X_s (1 - e^-(gamma p))      what is left for the growing part
//
// so that a pull that only goes on bears sigma, the curve that the user gave, whatever X_s is.
// Along one direction, back and forth, this is the law's own integral, in steps of any length.
// It makes stationary what the increment takes,
//
//     W + d mean R + X_s (d - m d) + m d sqrt(6) mu n.b      of which all but W is X's and R's work
//
// so forces are its exact gradient and their slope is symmetric. As sigma never falls, the
// equation's left side less its right falls by d, if C < 3 mu / 2; it is solved by Newton's method
// within bounds, each lane by itself. B has not E's axes, so its stress is no series in Y.
//
// NOTE: the mean m in n, where the law's end would have e^-x: with that there is no such increment,
// and the slope has no symmetry. The two differ in where the direction of flow turns, by x b / 2 in
// n, and then what a step leaves is beyond the surface by some (x b)^2 / 8, which the next takes.
//
// Sources: P. Armstrong & C. Frederick, CEGB report RD/B/N731, 1966; J.-L. Chaboche, "Time-
// independent constitutive theories for cyclic plasticity", Int. J. Plasticity 2, 1986; of the
// increment's energy M. Ortiz & L. Stainier, Comput. Methods Appl. Mech. Eng. 171, 1999.
#pragma once

#include <array>

#include "laws/cell.h"
#include "laws/dual.h"
#include "laws/lane_power.h"

namespace swage {

template <typename N>
struct BackStrain {
    Symmetric<N> strain;  // B
    CellModes<N> modes;   // beta [m]
};
template <typename N>
SWAGE_INLINE BackStrain<Dual<N>> constant(const BackStrain<N>& v) {
    return {constant(v.strain), constant(v.modes)};
}

// A number without its slope, and back.
template <typename N>
SWAGE_INLINE const N& value_of(const N& v) {
    return v;
}
template <typename N>
SWAGE_INLINE const N& value_of(const Dual<N>& v) {
    return v.value;
}
template <typename N, typename V>
SWAGE_INLINE N number_of(const V& v) {
    if constexpr (requires(N n) { n.slope; }) {
        return constant(v);
    } else {
        return v;
    }
}

// What is left of what fades away, e^-x, its mean m on the way there, and -dm/dx = (m - e^-x) / x.
template <typename V>
struct Fading {
    V left, mean, bend;
};
template <typename V>
SWAGE_INLINE Fading<V> fading(const V& x) {  // x >= 0
    constexpr double kGone = 600, kSmall = 0.5;
    constexpr int kTerms = 16;
    // Where x is small, bend is the sum of k (-x)^(k-1) / (k + 1)!.
    constexpr std::array<double, kTerms> term = [] {
        std::array<double, kTerms> t{};
        double factorial = 1;
        for (int k = 1; k <= kTerms; ++k) {
            factorial *= k + 1;
            t[k - 1] = (k % 2 ? k : -k) / factorial;
        }
        return t;
    }();
    V sum = term[kTerms - 1] + V{};
    for (int k = kTerms - 2; k >= 0; --k) sum = term[k] + x * sum;
    const V mean = (1.0 + x * sum) / (1.0 + x);
    const V limit = kSmall + V{}, safe = larger(x, limit);
    const V far = power_of_e(larger(V(-safe), V(V{} - kGone))), far_mean = (1.0 - far) / safe,
            far_bend = (far_mean - far) / safe;
    const auto small = x < limit;
    return {small ? 1.0 - x * mean : far, small ? mean : far_mean, small ? sum : far_bend};
}

template <typename N>
struct BackReturn : CellReturn<N> {
    N lent;          // after the return z is kept z + lent b,
    N gained, held;  // and b is gained z + held b
    N more;          // what flow takes per d_alpha beyond the mean of sigma [Pa]
};

// `own`, `both`, `back`: |z|^2, z.b and |b|^2.
template <typename N>
SWAGE_INLINE BackReturn<N> return_with_back(const CellModuli& law, const N& own, const N& both,
                                            const N& back, const N& alpha) {
    using V = std::remove_cvref_t<decltype(value_of(own))>;
    constexpr int kMostRounds = 60;
    constexpr double kTiny = 1e-300, kClose = 1e-11;  // the last step squares what is left
    const double scale = std::sqrt(6.0) * law.shear, rate = law.back_rate, firm = 3 * law.shear;
    const auto along = [&](const auto& stress, const auto& reached) __attribute__((always_inline)) {
        if (!law.curve.empty()) {
            return return_to(law, line_at(law.curve, stress + firm * reached), stress, reached);
        }
        return return_to(law, FlowLine<double>{law.yield_stress, law.hardening}, stress, reached);
    };
    // What sigma(alpha) still holds of X_s: it fades as X comes to it.
    const V held_back = law.back_stress * fading(V(rate * value_of(alpha))).left,
            spare = law.back_stress - held_back;
    // |z - m b|, n.b, and the stress on trial as if nothing shifted.
    const auto way = [&]<typename M>(const M& a, const M& ab, const M& b, const M& left,
                                     const M& mean, const M& apart) __attribute__((always_inline)) {
        const M square = a - 2.0 * (mean * ab) + mean * mean * b;
        const M size = root(larger(square, 0.0 * square)) + kTiny;
        const M turn = (ab - mean * b) / size;
        const M stress = scale * (size + apart * turn) + number_of<M>(spare) * left;
        return std::array<M, 3>{size, turn, stress};
    };
    const V a = value_of(own), ab = value_of(both), b = value_of(back), at = value_of(alpha);
    const V none{};
    V d = none, low = none, over = none, slope_left = none;
    V high = (scale * (root(a) + root(b)) + law.back_stress) * (1 / firm);
    const V close = kClose * high;
    V moving = none + 1.0;
    Fading<V> f = fading(none);
    for (int round = 0; round < kMostRounds; ++round) {
        const V x = rate * d;
        f = fading(x);
        const auto [size, turn, stress] = way(a, ab, b, f.left, f.mean, V(x * f.bend));
        const CellReturn<V> r = along(stress, at);
        if (round == 0) over = r.over;
        const V across = larger(b - turn * turn, none);
        const V rise =
            rate * (scale * (f.left * turn + x * f.bend * f.bend * across / size) - spare * f.left);
        slope_left = 1.0 / (1.0 - rise / (firm + r.line.slope));
        const V miss = r.d_alpha - d;
        low = miss > none ? d : low;
        high = miss < none ? d : high;
        V next = d + slope_left * miss;
        const V middle = 0.5 * (low + high);
        next = next < low ? middle : next;
        next = next > high ? middle : next;
        const V change = next > d ? next - d : d - next;
        next = moving > none ? next : d;
        d = next;
        moving = change > close ? moving : none;
        if (!is_any(moving > 0.0)) break;
    }
    // Once more, with the slopes of all that has some.
    const V x = rate * d;
    f = fading(x);
    const N left = number_of<N>(f.left), mean = number_of<N>(f.mean);
    const auto trial = way(own, both, back, left, mean, number_of<N>(V(x * f.bend)));
    BackReturn<N> r;
    static_cast<CellReturn<N>&>(r) = along(trial[2], alpha);
    r.over = number_of<N>(over);
    const N step = number_of<N>(slope_left) * (r.d_alpha - number_of<N>(d));
    r.d_alpha = number_of<N>(d) + step;
    const N left_then = left - rate * (left * step);
    const N mean_then = mean - rate * (number_of<N>(f.bend) * step);
    const auto end = way(own, both, back, left_then, mean_then, mean_then - left_then);
    const N share = std::sqrt(1.5) * r.d_alpha / end[0];
    r.kept = 1.0 - share;
    r.lent = share * mean_then;
    r.gained = (law.back_stress / scale) * (1.0 - left_then) / end[0];
    r.held = left_then - r.gained * mean_then;
    r.more = mean_then * (scale * end[1] - number_of<N>(spare));
    return r;
}

// Trial state and return, as CellFlowed.
template <typename N>
struct BackFlowed : BackReturn<N> {
    Symmetric<N> distortion;
    CellModes<N> modes, mode_stress, back_stress;  // the last: of beta
    N mode_flow, kept_modes;                       // as CellFlowed
    ModesReturn<N> alone;
    SWAGE_INLINE N whole_d_alpha() const { return this->d_alpha + alone.d_alpha; }
};
template <typename N>
SWAGE_INLINE BackFlowed<N> flow_with_back(const CellModuli& law, const CellHistory<N>& history,
                                          const BackStrain<N>& back, const Symmetric<N>& strain,
                                          const CellModes<N>& modes, const N& fill) {
    const Symmetric<N> a = taken_back(history);
    BackFlowed<N> r;
    r.distortion = deviator(strain);
    r.modes = modes - history.modes;
    r.mode_stress = mode_stress(law, a, r.modes);
    r.back_stress = mode_stress(law, a, back.modes);
    r.mode_flow = mode_flow(fill);
    const N share = (0.5 / (law.shear * law.spacing * law.spacing * law.spacing)) *
                    (r.mode_flow * mode_share(fill));
    static_cast<BackReturn<N>&>(r) = return_with_back(
        law, contract(r.distortion, r.distortion) + share * product(r.mode_stress, r.modes),
        contract(r.distortion, back.strain) + share * product(r.back_stress, r.modes),
        contract(back.strain, back.strain) + share * product(r.back_stress, back.modes),
        history.alpha);
    const N energy = product(r.mode_stress, r.modes);
    r.alone =
        return_modes<N>(law, r, ((1.0 - r.mode_flow) * mode_share(fill)) * energy, history.alpha);
    r.kept_modes = kept_of_modes<N>(r.mode_flow, r, r.alone);
    return r;
}

// By how much it lowers the energy of the increment, per volume of material [J/m3].
inline double saved_by_flow(const CellModuli& law, double alpha, const BackStrain<double>& back,
                            double fill, const BackFlowed<double>& r) {
    const double share = mode_share(fill) / (law.spacing * law.spacing * law.spacing);
    const auto energy = [&](const Symmetric<double>& e, const CellModes<double>& q,
                            const CellModes<double>& g) {
        return law.shear * contract(e, e) + 0.5 * share * product(g, q);
    };
    return energy(r.distortion, r.modes, r.mode_stress) -
           energy(r.kept * r.distortion + r.lent * back.strain,
                  r.kept_modes * r.modes + r.lent * back.modes,
                  r.kept_modes * r.mode_stress + r.lent * r.back_stress) -
           r.d_alpha * (mean_flow_stress(law, alpha, r.d_alpha) + r.more) -
           r.alone.took;
}

// 2 dw/dC of dw/dE = t, of any axes: (I - Y) (t + (t Y^2 + Y t Y + Y^2 t) / 3 + ...) (I - Y).
template <typename N>
SWAGE_INLINE Symmetric<N> material_stress(const CellStrain<N>& e, const Symmetric<N>& t) {
    const Symmetric<N>&y = e.cayley, &y2 = e.square;
    const Symmetric<N> sides = both_ways(t, y2);
    const Symmetric<N> s = t + (1.0 / 3) * sides + 0.2 * both_ways(t, square(y2)) +
                           between(y, (1.0 / 3) * t + 0.2 * sides) + 0.2 * between(y2, t);
    return between(
        Symmetric<N>{1.0 - y.xx, 1.0 - y.yy, 1.0 - y.zz, -1.0 * y.xy, -1.0 * y.yz, -1.0 * y.zx}, s);
}

}  // namespace swage
