// SPDX-License-Identifier: GPL-3.0-or-later
// 1 / sqrt(q) of a number or of a batch of lanes. Root and division of doubles take most of a
// spring's time; those of floats are four times as fast and exact too, so they give the guess y,
// and one step of third order the rest:
//
//     r = 1 - q y^2,   y += y r (1/2 + 3/8 r)        error e -> 5/2 e^3
//
// From 1e-7 that leaves what rounding does, at most 3 units of the last place. The same operations
// in each lane and on each machine, so the same bits. q = 0 gives a large finite number, q beyond
// the floats 0.
#pragma once

#include "laws/lane_tensor.h"

namespace swage {

inline constexpr double kLeastRooted = 1e-36;

SWAGE_INLINE double guess_inverse_root(double q) {
    return 1.0f / std::sqrt(static_cast<float>(q + kLeastRooted));
}
template <LaneVector V>
SWAGE_INLINE V guess_inverse_root(const V& q) {
    typedef typename LaneBatch<kWidthOf<V>>::Floats Floats;
    const Floats f = __builtin_convertvector(q + kLeastRooted, Floats);
    Floats r;
    for (int l = 0; l < kWidthOf<V>; ++l) r[l] = __builtin_sqrtf(f[l]);
    return widened<V>(1.0f / r);
}

// Of several numbers side by side; each q >= 0.
template <typename N, int kCount>
SWAGE_INLINE void inverse_roots(const N (&q)[kCount], N (&y)[kCount]) {
    N r[kCount];
    for (int i = 0; i < kCount; ++i) y[i] = guess_inverse_root(q[i]);
    for (int i = 0; i < kCount; ++i) r[i] = 1.0 - q[i] * y[i] * y[i];
    for (int i = 0; i < kCount; ++i) y[i] = y[i] + y[i] * r[i] * (0.5 + 0.375 * r[i]);
}

}  // namespace swage
