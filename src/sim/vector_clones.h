// SPDX-License-Identifier: GPL-3.0-or-later
// One binary for every x86-64: the widest vectors are chosen when it starts. All kernels do the
// same exact operations lane by lane, so they give the same bytes.
#pragma once

#include "base/vector_targets.h"
#include "laws/lane_tensor.h"

namespace swage {

// What SWAGE_VECTOR_CLONES reckon with: where the machine's vectors are of four, gcc 12 takes those
// of eight through memory, and compares and chooses them number by number.
inline constexpr int kFewLanes = 4;
using FewLanes = LanesOf<kFewLanes>;

// Numbers in the vectors of the kernels that this machine runs: 8, 4 or 2.
int vector_width();
// Kernels of at most this width from now on; 0: as wide as the machine has them.
void limit_vector_width(int width);

// Kernels in functions that are built for one width: what they do has to be inlined all the way.
template <typename Kernel>
[[gnu::noinline]] SWAGE_WIDE_VECTORS void in_wide(const Kernel& kernel) {
    kernel();
}
template <typename Kernel>
[[gnu::noinline]] SWAGE_MIDDLE_VECTORS void in_middle(const Kernel& kernel) {
    kernel();
}
template <typename Kernel>
[[gnu::noinline]] void in_narrow(const Kernel& kernel) {
    kernel();
}
// Does one of the width that is named, in a copy that all who come this way share:
// in_width<kWidth>([&]() __attribute__((always_inline)) { ... })
template <int kWidth, typename Kernel>
SWAGE_INLINE void in_width(const Kernel& kernel) {
    if constexpr (kWidth == 8) in_wide(kernel);
    if constexpr (kWidth == 4) in_middle(kernel);
    if constexpr (kWidth == 2) in_narrow(kernel);
}
// Does one of any width by that of this machine:
// by_width([&]<int kWidth>() __attribute__((always_inline)) { ... })
template <typename Kernel>
void by_width(const Kernel& kernel) {
    const auto in = [&]<int kWidth>() {
        in_width<kWidth>([&]() __attribute__((always_inline)) {
            kernel.template operator()<kWidth>();
        });
    };
    const int width = vector_width();
    width == 8   ? in.template operator()<8>()
    : width == 4 ? in.template operator()<4>()
                 : in.template operator()<2>();
}
// Does one that is of four numbers everywhere:
// by_fours([&]() __attribute__((always_inline)) { ... })
template <typename Kernel>
void by_fours(const Kernel& kernel) {
    vector_width() >= 4 ? in_middle(kernel) : in_narrow(kernel);
}

}  // namespace swage
