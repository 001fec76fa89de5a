// SPDX-License-Identifier: GPL-3.0-or-later
// Along each axis the section of the matter grows by what of the surface faces that way, and
// shrinks by what faces the other (as in shares.cpp). Squares across which there is none, that lie
// beside each other, are one gap.
#include "mold/filled_gaps.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <tuple>

#include "geometry/disjoint_sets.h"

namespace swage {

namespace {

constexpr double kNothing = 1e-9;  // [cells' faces], of a section
// NOTE: what enters a cell on one side and leaves it on the other may do so within it, but only one
// after the other if both sections do not fit beside each other.
constexpr double kOverlap = 1.05;
constexpr int kDeep = 2;  // [cells], to both sides along the gap

struct Square {
    int axis;
    Vec3i cell;    // on its low face, or across it
    int plane;     // along the axis [half cells]
    double width;  // of the gap there [cells]
};

struct WallsOfCell {
    Vec3i cell;
    const CellWalls* wall;
};

void find_across(int axis, std::vector<WallsOfCell>& walls, const std::vector<CellLayer>& layers,
                 std::vector<Square>& found) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto column = [&](const Vec3i& c) { return std::pair(c[v], c[u]); };
    std::sort(walls.begin(), walls.end(), [&](const WallsOfCell& a, const WallsOfCell& b) {
        return std::tuple(column(a.cell), -a.cell[axis]) <
               std::tuple(column(b.cell), -b.cell[axis]);
    });
    const auto fill_of = [&](const Vec3i& c) {
        const CellFill* const share = share_of(layers, c.x(), c.y(), c.z());
        return share != nullptr ? share->fill : 0.0;
    };
    double section = 0;  // at the high face
    for (std::size_t n = 0; n < walls.size(); ++n) {
        const auto& [cell, wall] = walls[n];
        if (n > 0 && column(walls[n - 1].cell) != column(cell)) section = 0;
        const double high = section, ends = wall->toward[2 * axis],
                     begins = wall->toward[2 * axis + 1];
        const double low = section = high + ends - begins;
        const double fill = fill_of(cell);
        if (!(fill > 0)) continue;
        const Vec3i below = cell - Vec3i::Unit(axis);
        const double beside = low < kNothing ? fill_of(below) : 0.0;
        if (beside > 0) {
            found.push_back({axis, cell, 2 * cell[axis], 2 - fill - beside});
        } else if (low + high > kOverlap && ends > low - kNothing && begins > high - kNothing) {
            found.push_back({axis, cell, 2 * cell[axis] + 1, 1 - fill});
        }
    }
}

// Those beside each other.
DisjointSets grouped(const std::vector<Square>& square) {
    DisjointSets groups(square.size());
    std::map<std::tuple<int, int, int, int>, int> at;
    const auto key = [&](const Square& s, int along, int by, int plane) {
        Vec3i c = s.cell;
        c[along] += by;
        return std::tuple(s.axis, c[(s.axis + 1) % 3], c[(s.axis + 2) % 3], plane);
    };
    for (std::size_t n = 0; n < square.size(); ++n) {
        at[key(square[n], 0, 0, square[n].plane)] = static_cast<int>(n);
    }
    for (std::size_t n = 0; n < square.size(); ++n) {
        const Square& s = square[n];
        for (int along : {(s.axis + 1) % 3, (s.axis + 2) % 3}) {
            for (int aside = -2; aside <= 2; ++aside) {  // a gap may stand askew
                const auto next = at.find(key(s, along, 1, s.plane + aside));
                if (next != at.end()) groups.unite(static_cast<int>(n), next->second);
            }
        }
    }
    return groups;
}

}  // namespace

std::vector<FilledGap> filled_gaps(const std::vector<CellLayer>& layers, const MoldFrame& frame) {
    std::vector<WallsOfCell> walls;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        for (const CellWalls& w : layers[k].wall) {
            walls.push_back({Vec3i(w.i, w.j, static_cast<int>(k)), &w});
        }
    }
    std::vector<Square> square;
    for (int axis = 0; axis < 3; ++axis) find_across(axis, walls, layers, square);
    struct Group {
        Vec3i low = Vec3i::Constant(std::numeric_limits<int>::max()),
              high = Vec3i::Constant(std::numeric_limits<int>::min());
        int axis = 0;
        Vec3 bins = Vec3::Zero();
        double width = std::numeric_limits<double>::infinity();
        int count = 0;
    };
    std::vector<int> number;
    std::vector<Group> groups(static_cast<std::size_t>(grouped(square).number_sets(number)));
    for (std::size_t n = 0; n < square.size(); ++n) {
        const Square& s = square[n];
        Group& group = groups[number[n]];
        group.axis = s.axis;
        group.low = group.low.cwiseMin(s.cell), group.high = group.high.cwiseMax(s.cell);
        Vec3 middle = (2 * s.cell + Vec3i::Ones()).cast<double>();
        middle[s.axis] = s.plane;
        group.bins += middle;
        group.width = std::min(group.width, s.width);
        ++group.count;
    }
    std::vector<FilledGap> gaps;
    for (const Group& group : groups) {
        const Vec3i size = group.high - group.low + Vec3i::Ones();
        if (size[(group.axis + 1) % 3] < kDeep || size[(group.axis + 2) % 3] < kDeep) continue;
        gaps.push_back({frame.point(group.bins / group.count), group.width * frame.spacing,
                        group.count * frame.spacing * frame.spacing});
    }
    std::ranges::stable_sort(gaps, std::greater<>(), &FilledGap::area);
    return gaps;
}

}  // namespace swage
