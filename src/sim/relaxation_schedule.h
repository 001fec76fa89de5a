// SPDX-License-Identifier: GPL-3.0-or-later
// How a relaxation goes on: with the momentum of Nesterov (Soviet Math. Dokl. 27, 1983), which
// begins anew where it goes against the forces (O'Donoghue and Candes, Found. Comput. Math. 15,
// 2015), in steps that then are shorter for a while, as in FIRE (Bitzek and others, Phys. Rev.
// Lett. 97, 170201, 2006); and when to give up.
#pragma once

#include "sim/vector_sums.h"

namespace swage {

struct Momentum {
    double step = 1;
    int since = 0;  // it began

    // The share of the speed that stays.
    double downhill() {
        if (++since > 5) step = std::min(1.0, 1.1 * step);
        return since / (since + 3.0);
    }
    void uphill() {
        since = 0;
        step = std::max(0.3, 0.5 * step);
    }
};

// How long to go on. A body that snaps or slips out is let go where it will, and one that settles
// may settle: smaller increments would only come to the same brink.
struct Patience {
    static constexpr int kEscape =
        10;  // times the iterations, for a body that still goes far or settles

    int limit, half, most;
    Vec3Array position;  // half a limit ago
    double residual = 0;

    Patience(int iterations, const Vec3Array& x)
        : limit(iterations), half(iterations / 2), most(kEscape * iterations), position(x) {}

    void watch(int iteration, const Vec3Array& x, double spacing, double now) {
        const bool at_end = iteration == limit && limit < most;
        if (at_end && !(farthest_move(position, x) > spacing || now < 0.5 * residual)) return;
        if (at_end) limit += half;
        if (at_end || iteration == limit - half) {
            position = x;
            residual = now;
        }
    }
};

}  // namespace swage
