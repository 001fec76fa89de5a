// SPDX-License-Identifier: GPL-3.0-or-later
// Lanes read from memory and written to it, wherever they begin.
#pragma once

#include <cstring>

#include "laws/lane_tensor.h"

namespace swage {

template <typename V>
SWAGE_INLINE V load(const double* from) {
    V v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
template <typename V>
SWAGE_INLINE V load(const float* from) {
    return widened<V>(from);
}
template <typename V>
SWAGE_INLINE void store(const V& v, double* to) {
    std::memcpy(to, &v, sizeof v);
}

}  // namespace swage
