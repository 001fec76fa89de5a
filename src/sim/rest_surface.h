// SPDX-License-Identifier: GPL-3.0-or-later
// How deep a place of a body lies below its surface in the shape that it was molded in: what other
// bodies' points meet. Made from the body's surface points, each with its normal. Of one side of an
// edge, over the points within one spacing along the surface,
//
//     d(g) = sum_i w_i (n_i + n) / 2 . (g - g_i)        n = sum_i w_i n_i, unit;
//
// of several sides the largest where they meet in a convex edge, the least in a concave one. Exact
// for planes; on a surface of radius R n_i . (g - g_i) alone is wrong by -t^2 / 2R at a distance t
// from the foot, n . (g - g_i) by +t^2 / 2R, so that of the mean only the fourth order is left.
//
// It is sampled at the corners of cells and interpolated. Where that does not serve, at edges, it
// is sampled four times as finely and interpolated along the edges of tetrahedra (Kuhn's six of a
// cube, each cube the mirror image of its neighbours, so that an edge along the lattice keeps its
// shape). Where such a cell meets another, that one's values hold, and by how much its face is not
// flat is added to this cell, less and less toward the far side. So depth is one continuous
// function of the place, and what pushes by its slope gains no energy by the way it goes.
// A body lies within its cells: where these end, what the mean over an edge makes less than zero is
// zero, so that what comes in there is not deep in it at once.
// All lengths in spacings, all places in cells from the lattice's origin.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

// What a body's last cells hold beyond themselves, in cells: slivers too small to be cells.
inline constexpr double kSliver = 0.2;

struct SurfaceDepth {
    double distance;  // less than zero inside
    Vec3 gradient;
};

// From those at a cell's corners, 0 to 1 along each axis.
SurfaceDepth interpolate_depth(const std::array<float, 8>& corner, const Vec3& place);

class RestSurface {
  public:
    // `ends`: whether the body ends with its cells.
    explicit RestSurface(const Aggregate& matter, bool ends = true);
    // Whether those of both are the same: of bodies that are molded alike one serves.
    static bool is_shared(const Aggregate& a, const Aggregate& b);

    using Depth = SurfaceDepth;
    // `place` in the cell, each 0 to 1, or a little outside. Nothing is known of cells that lie
    // deeper than three spacings: they are no rim.
    Depth at(CellId cell, const Vec3& place) const;
    // Of a place beyond a cell where there is none: what a sliver there holds ends with it, so that
    // what comes in is not deep at once.
    Depth at_sliver(CellId cell, const Vec3& place) const;
    bool is_rim(CellId cell) const { return slot_[cell] >= 0; }
    // Cells that lie, wholly or in part, less than a spacing deep: in their order.
    const std::vector<CellId>& skin() const { return skin_; }

  private:
    static constexpr int kFine = 4;  // samples along an edge of a cell, but for the last
    static constexpr int kSamples = (kFine + 1) * (kFine + 1) * (kFine + 1);

    struct Site {
        std::uint64_t key;
        int first, count;  // points
    };
    struct Fine {
        std::array<double, kSamples> sample{};  // x first
        // Of the faces, low and high along x, y, z, that a cell known by its corners shares.
        std::array<double, 6> twist{};
        bool has_twist = false;
    };
    struct Near {
        std::vector<int> point;  // in their order
        double reach;            // all within it of any place asked about are there
    };
    void bin_points(const Aggregate& matter);
    void index_rows(const std::vector<Vec3i>& site_of_bin);
    std::vector<CellId> find_rim(const Lattice& lattice, const std::vector<Vec3i>& site_of_bin);
    void gather(const Vec3& low, const Vec3& high, double reach, Near& near) const;
    // Of a place as far as `near` tells; no number where it does not reach.
    double distance(const Vec3& g, const Near& near) const;
    double distance(const Vec3& g) const;
    void measure_corners(const Lattice& lattice);
    bool is_flat(int slot, const Near& near) const;
    void find_fine(std::vector<char>& is_fine) const;
    void measure_fine(const Lattice& lattice, const std::vector<char>& is_fine);

    bool ends_;
    std::vector<Vec3> point_, normal_;  // sorted by bin
    std::vector<Site> bin_;
    Vec3i row_low_{0, 0, 0}, row_count_{0, 0, 0};  // rows of bins along x: by y, then z
    std::vector<int> row_;                         // first bin of each, and one beyond
    std::vector<int> slot_;                        // of each cell, -1: no rim
    std::vector<CellId> skin_;
    // By slot: distances at the corners, and which of the finely sampled it is, or -1.
    std::vector<std::array<float, 8>> corner_;
    std::vector<int> fine_of_;
    std::vector<Vec3i> site_;
    std::vector<Fine> fine_;
};

}  // namespace swage
