// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/vector_clones.h"

#include <algorithm>

namespace swage {

namespace {

int widest() {
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    if (__builtin_cpu_supports("avx512f")) return 8;
    if (__builtin_cpu_supports("avx2")) return 4;
#endif
    return 2;
}
int limit = 8;

}  // namespace

int vector_width() {
    static const int own = widest();
    return std::min(own, limit);
}

void limit_vector_width(int width) { limit = width > 0 ? width : 8; }

}  // namespace swage
