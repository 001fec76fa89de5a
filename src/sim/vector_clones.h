// SPDX-License-Identifier: GPL-3.0-or-later
// One binary for every x86-64: the widest vectors are chosen when it starts. All kernels do the
// same exact operations lane by lane, so they give the same bytes.
#pragma once

#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SWAGE_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define SWAGE_VECTOR_CLONES
#endif
