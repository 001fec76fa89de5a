// SPDX-License-Identifier: GPL-3.0-or-later
// Three components in one vector of four lanes, for kernels that gather particle by particle. What
// the fourth lane holds is for the caller to say. Everything is inlined into the kernel that asks.
#pragma once

#include <cstring>

#include "base/math.h"
#include "laws/lane_tensor.h"

namespace swage {

typedef double Vec4 __attribute__((vector_size(32)));
typedef long long Index4 __attribute__((vector_size(32)));

SWAGE_INLINE Vec4 vec4(const Vec3& v, double fourth = 0) {
    return Vec4{v.x(), v.y(), v.z(), fourth};
}
SWAGE_INLINE Vec3 vec3(Vec4 v) { return {v[0], v[1], v[2]}; }

// The fourth lane is zero, or no number where one of theirs is infinite.
SWAGE_INLINE Vec4 cross(Vec4 a, Vec4 b) {
    const Index4 next{1, 2, 0, 3};
    const Vec4 turned = a * __builtin_shuffle(b, next) - __builtin_shuffle(a, next) * b;
    return __builtin_shuffle(turned, next);
}
// A share of a force on the first three lanes, and its size on the fourth.
SWAGE_INLINE Vec4 share_lanes(double share) {
    const Index4 but_sign{-1, -1, -1, 0x7fffffffffffffff};
    return (Vec4)((Index4)Vec4{share, share, share, share} & but_sign);
}
// Of the first three lanes.
SWAGE_INLINE double dot3(Vec4 a, Vec4 b) {
    const Vec4 p = a * b;
    return p[0] + p[1] + p[2];
}

}  // namespace swage
