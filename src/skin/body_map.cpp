// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/body_map.h"

#include <Eigen/LU>

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

#include "matter/cell_middle.h"

namespace swage {

namespace {

constexpr double kThinnest = 1e-3;  // of a cell's volume at rest, below which none is looked for

}  // namespace

BodyMap::BodyMap(const Aggregate& matter) : matter_(matter) {
    std::vector<ParticleId> all(matter.particle_count());
    std::iota(all.begin(), all.end(), 0);
    particle_frames(matter, make_frame_stencil(matter), all, frame_);
}

CellFrames BodyMap::frames(const std::array<ParticleId, 8>& corner) const {
    CellFrames cell;
    for (int c = 0; c < 8; ++c) cell.corner.col(c) = frame_[corner[c]];
    cell.size = matter_.particle_reference.at(corner[7]) - matter_.particle_reference.at(corner[0]);
    return cell;
}

Vec3 BodyMap::world(const BodyPlace& place) const {
    const auto [corner, carrier, followed] = carriage_of(matter_, place);
    const CellFrames cell = frames(corner);
    Vec3 world =
        place.reference + (followed == kAllCorners ? whole_displacement(half_frames(cell), carrier)
                                                   : part_displacement(cell, carrier, followed));
    if (!place.hold.isZero(0)) world += nearest_rotation(mean_slope(cell, followed)) * place.hold;
    return world;
}

Mat3 BodyMap::slope(CellId cell, CornerMask side) const {
    return mean_slope(frames(matter_.lattice.cell_corners(cell)), side);
}

std::optional<BodyPlace> BodyMap::solve(CellId cell, CornerMask side, const Vec3& world) const {
    const Mat3 slope = this->slope(cell, side);
    if (std::abs(slope.determinant()) < kThinnest) return std::nullopt;
    const Mat3 inverse = slope.inverse();
    const CellBox box = cell_box(matter_, cell);
    BodyPlace place{box.low + 0.5 * box.size, cell, side};
    const double a = matter_.lattice.spacing;
    for (int round = 0; round < 40; ++round) {
        const Vec3 gap = world - this->world(place);
        if (gap.norm() < 1e-12 * a) break;
        place.reference += inverse * gap;
        if ((place.reference - box.low - 0.5 * box.size).norm() > 3 * a) return std::nullopt;
    }
    return place;
}

MappedCell BodyMap::mapped(CellId cell) const {
    const CellBox box = cell_box(matter_, cell);
    return {cell, cell_middle(matter_, cell), box.low + 0.5 * box.size};
}

BodyPlace BodyMap::place_at(const Vec3& world, const std::vector<MappedCell>& cells,
                            const BodyPlace& near, const PieceMap& pieces) const {
    constexpr std::size_t kTried = 8;
    const int piece = pieces.piece_of(near);
    const double a = matter_.lattice.spacing;
    const Vec3 way = world - this->world(near);
    // Of what is pressed to a third.
    const double reach = 4 * a + 3 * way.norm();
    std::vector<std::tuple<bool, double, CellId>> nearest;
    nearest.reserve(cells.size());
    for (const MappedCell& one : cells) {
        const bool is_far = (one.reference - near.reference).squaredNorm() > reach * reach;
        nearest.emplace_back(is_far, (one.middle - world).squaredNorm(), one.cell);
    }
    const std::size_t tried = std::min(kTried, nearest.size());
    std::partial_sort(nearest.begin(), nearest.begin() + tried, nearest.end());

    std::optional<BodyPlace> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < tried; ++n) {
        const auto& [is_far, distance2, cell] = nearest[n];
        if (is_far && best) break;
        const CornerGroups groups = corner_groups(matter_, matter_.lattice.cell_corners(cell));
        CornerMask seen = 0;
        for (CornerMask group : groups) {
            if (group & seen) continue;
            seen |= group;
            if (!pieces.follows(cell, group, piece)) continue;
            const std::optional<BodyPlace> place = solve(cell, group, world);
            if (!place) continue;
            // How far the place lies outside the cell, and outside the share of its corners, and
            // how far from the world's place the search has ended.
            const CellBox box = cell_box(matter_, cell);
            const Vec3 local = (place->reference - box.low).cwiseQuotient(box.size);
            double outside = (local - local.cwiseMax(0.0).cwiseMin(1.0)).norm();
            const auto weight = trilinear_weights(local.cwiseMax(0.0).cwiseMin(1.0));
            if (!(group >> heaviest_corner(weight, kAllCorners) & 1)) outside += 0.5;
            outside += (world - this->world(*place)).norm() / a;
            if (outside < least) least = outside, best = place;
        }
        if (least < 1e-9) break;
    }
    if (best) return *best;
    // Far outside of all matter, as a skin on a block may be: it hangs on the next place.
    BodyPlace guess = near;
    const Mat3 slope = this->slope(near.cell, near.side);
    guess.reference += std::abs(slope.determinant()) < kThinnest ? way : slope.inverse() * way;
    return guess;
}

}  // namespace swage
