// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Calls act(lower, upper, weight) for each connection that holds.
template <typename Act>
void for_each_connection(const Lattice& lattice,
                         const std::array<ConnectionArrays, kForwardCount>& connection,
                         const Act& act) {
    for (const Span& span : lattice.span) {
        const SparseArray<float>& weight = connection[span.direction].weight;
        for (int n = 0; n < span.count; ++n) {
            const float share = weight[span.lower + n];
            if (share > 0) act(span.lower + n, span.upper + n, share);
        }
    }
}

}  // namespace swage
