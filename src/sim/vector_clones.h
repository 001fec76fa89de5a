// SPDX-License-Identifier: GPL-3.0-or-later
// One binary for every x86-64: the widest vectors are chosen when it starts. All kernels do the
// same exact operations lane by lane, so they give the same bytes.
#pragma once

#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SWAGE_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
// For kernels that are written for a width: eight, four or two numbers.
#define SWAGE_WIDE_VECTORS __attribute__((target("avx512f")))
#define SWAGE_MIDDLE_VECTORS __attribute__((target("avx2")))
#else
#define SWAGE_VECTOR_CLONES
#define SWAGE_WIDE_VECTORS
#define SWAGE_MIDDLE_VECTORS
#endif

namespace swage {

// Numbers in the vectors of the kernels that this machine runs: 8, 4 or 2.
int vector_width();
// Kernels of at most this width from now on; 0: as wide as the machine has them.
void limit_vector_width(int width);

}  // namespace swage
