// SPDX-License-Identifier: GPL-3.0-or-later
// One binary for every x86-64: functions so marked are built for several widths of vectors, and the
// widest that the machine has is chosen when it starts. Sums keep their order, so that all give the
// same bytes.
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
