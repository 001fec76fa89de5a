// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers by counter: the same for the same number, whoever asks, in whatever order.
#pragma once

#include <cstdint>

namespace swage {

// -1 to 1 (S. Vigna's splitmix64).
inline double noise(std::uint64_t n) {
    n = (n + 1) * 0x9e3779b97f4a7c15ull;
    n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9ull;
    n = (n ^ (n >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((n ^ (n >> 31)) >> 11) * 0x1p-52 - 1;
}

}  // namespace swage
