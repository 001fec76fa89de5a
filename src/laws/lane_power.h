// SPDX-License-Identifier: GPL-3.0-or-later
// Powers of positive numbers, lane by lane the same bytes in vectors of any width, to some 1e-15
// times 1 + |e ln x|. (SLEEF's vectors are declared only in files that are built for one width.)
//
//     x = 2^k m, m from sqrt(1/2) to sqrt(2): ln m = 2 (s + s^3/3 + ...), s = (m - 1) / (m + 1)
//
//     e^y = 2^n e^r, |r| <= ln(2)/2: e^r by its series
//
// Both series are cut off where the rest is below 1e-17.
#pragma once

#include <bit>

#include "laws/dual.h"

namespace swage {

namespace lane_power {

inline constexpr double kLn2High = 0x1.62e42fee00000p-1, kLn2Low = 0x1.a39ef35793c76p-33;
inline constexpr double kOverLn2 = 1.4426950408889634;
inline constexpr long long kHalfRoot = 0x3fe6a09e667f3bcd;  // the bits of sqrt(1/2)
inline constexpr int kMantissa = 52;
// A whole number added to this stands in its last bits.
inline constexpr double kWhole = 0x1.8p52;

// e^y for |y| < 700 by bits of whole numbers I.
template <typename I, typename N>
SWAGE_INLINE N power_of_e(const N& y) {
    const N whole = kOverLn2 * y + kWhole, n = whole - kWhole;
    const N r = (y - kLn2High * n) - kLn2Low * n;
    constexpr int kTerms = 13;
    N sum = 1.0 + (1.0 / kTerms) * r;
    for (int t = kTerms - 1; t > 0; --t) sum = 1.0 + (1.0 / t) * (r * sum);
    return std::bit_cast<N>(std::bit_cast<I>(sum) + (std::bit_cast<I>(whole) << kMantissa));
}
// ln x.
template <typename I, typename N>
SWAGE_INLINE N logarithm(const N& x) {
    const I bits = std::bit_cast<I>(x), k = (bits - kHalfRoot) >> kMantissa;
    const N m = std::bit_cast<N>(bits - (k << kMantissa));
    const N exponent = std::bit_cast<N>(k + std::bit_cast<long long>(kWhole)) - kWhole;
    const N s = (m - 1.0) / (m + 1.0), z = s * s;
    constexpr int kTerms = 10;
    N sum = 1.0 / (2 * kTerms + 1) + N{};
    for (int t = kTerms - 1; t > 0; --t) sum = 1.0 / (2 * t + 1) + z * sum;
    return exponent * kLn2High + (2.0 * s + (2.0 * s * (z * sum) + exponent * kLn2Low));
}

}  // namespace lane_power

// e^y for |y| < 700.
SWAGE_INLINE double power_of_e(double y) { return lane_power::power_of_e<long long>(y); }
template <LaneVector V>
SWAGE_INLINE V power_of_e(const V& y) {
    return lane_power::power_of_e<typename LaneBatch<kWidthOf<V>>::Indices, V>(y);
}

// x^e, e one for all lanes.
SWAGE_INLINE double power(double x, double e) {
    return lane_power::power_of_e<long long>(e * lane_power::logarithm<long long>(x));
}
template <LaneVector V>
SWAGE_INLINE V power(const V& x, double e) {
    using I = typename LaneBatch<kWidthOf<V>>::Indices;
    return lane_power::power_of_e<I, V>(e * lane_power::logarithm<I, V>(x));
}
template <typename N>
SWAGE_INLINE Dual<N> power(const Dual<N>& x, double e) {
    const N p = power(x.value, e);
    return {p, (e * p / x.value) * x.slope};
}

}  // namespace swage
