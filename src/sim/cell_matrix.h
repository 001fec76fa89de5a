// SPDX-License-Identifier: GPL-3.0-or-later
// A cell's tangent as a small dense matrix.
#pragma once

#include <array>

#include "sim/flow.h"

namespace swage {

// Symmetric, of the eight corners' three components, 3 corner + component: the upper triangle by
// columns.
struct CellMatrix {
    static constexpr int kSize = 24;
    std::array<double, kSize*(kSize + 1) / 2> upper{};

    static int place(int row, int column) { return column * (column + 1) / 2 + row; }
    double operator()(int a, int b) const { return upper[a < b ? place(a, b) : place(b, a)]; }
};

// Which tangent: of what flows or not; a share `geometric` of what the stress does by turning
// with the matter, 1 being exact, and 0 the part that never makes a body unstable.
struct TangentKind {
    using IsPlain = TangentKind;
    Flow flow = Flow::trial;
    double geometric = 1;
    bool operator==(const TangentKind&) const = default;
};

}  // namespace swage
