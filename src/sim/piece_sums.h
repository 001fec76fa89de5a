// SPDX-License-Identifier: GPL-3.0-or-later
// Sums over the particles of each piece, in their order.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

template <typename Value, typename Of>
std::vector<Value> sums_of(const Pieces& pieces, const Value& none, const Of& of) {
    std::vector<Value> sum(static_cast<std::size_t>(pieces.count), none);
    for (std::size_t p = 0; p < pieces.particle_piece.size(); ++p) {
        sum[static_cast<std::size_t>(pieces.particle_piece[p])] += of(p);
    }
    return sum;
}

}  // namespace swage
