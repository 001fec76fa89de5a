// SPDX-License-Identifier: GPL-3.0-or-later
// How deep a place of a body lies below its surface in the shape that it was molded in: what other
// bodies' points meet. Made from the body's surface points, each with its normal.
//
//     d(g) = sum_i w_i (n_i + n) / 2 . (g - g_i)        n = sum_i w_i n_i, unit
//
// over the points of the same side of an edge within one spacing along the surface. Exact for
// planes; on a surface of radius R n_i . (g - g_i) alone is wrong by -t^2 / 2R at a distance t from
// the foot, n . (g - g_i) by +t^2 / 2R, so that of the mean only the fourth order is left.
// All lengths in spacings, all places in cells from the lattice's origin.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

class RestSurface {
  public:
    RestSurface(const Lattice& lattice, const SurfacePoints& points);

    struct Depth {
        double distance;  // less than zero inside
        Vec3 gradient;
    };
    // `place` in the cell, each 0 to 1, or a little outside. Nothing is known of cells that lie
    // deeper than three spacings: they are no rim.
    Depth at(CellId cell, const Vec3& place) const;
    bool is_rim(CellId cell) const { return slot_[cell] >= 0; }
    // Cells that lie, wholly or in part, less than a spacing deep: in their order.
    const std::vector<CellId>& skin() const { return skin_; }

  private:
    struct Site {
        std::uint64_t key;
        int first, count;  // points
    };
    std::vector<int> points_near(const Vec3i& site, int rings) const;
    Depth blend(const Vec3& g, int nearest, const int* begin, const int* end) const;
    Depth direct(const Vec3& g, const int* begin, const int* end) const;
    void measure();

    std::vector<Vec3> point_, normal_;  // sorted by bin
    std::vector<Site> bin_;
    std::vector<int> slot_;  // of each cell, -1: no rim
    std::vector<CellId> skin_;
    // By slot: distances at the corners where their interpolation serves; else the points to ask.
    std::vector<std::array<float, 8>> corner_;
    std::vector<Vec3i> site_;
    std::vector<int> list_begin_, list_;
};

}  // namespace swage
