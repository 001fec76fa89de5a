// SPDX-License-Identifier: GPL-3.0-or-later
// Where any place of the body at molding is now, and back.
#pragma once

#include <optional>
#include <vector>

#include "matter/aggregate.h"
#include "skin/carrier.h"
#include "skin/piece_map.h"

namespace swage {

// Where a cell's middle is now, and was at molding.
struct MappedCell {
    CellId cell;
    Vec3 middle, reference;
};

// A snapshot: the matter must outlive it and stay as it is.
class BodyMap {
  public:
    explicit BodyMap(const Aggregate& matter);

    Vec3 world(const BodyPlace& place) const;
    // The place that is now at `world`; searched in the cells, of those given, whose centres are
    // nearest, of those around `near` in the body first: what has gone into itself has more than
    // one. A place outside of all is the best guess. It follows the piece that `near` does.
    BodyPlace place_at(const Vec3& world, const std::vector<MappedCell>& cells,
                       const BodyPlace& near, const PieceMap& pieces) const;
    MappedCell mapped(CellId cell) const;

  private:
    CellFrames frames(const std::array<ParticleId, 8>& corner) const;
    Mat3 slope(CellId cell, CornerMask side) const;  // of the world by the body, in the mean
    // Nothing where the cell has no thickness or the search leaves its surroundings.
    std::optional<BodyPlace> solve(CellId cell, CornerMask side, const Vec3& world) const;

    const Aggregate& matter_;
    std::vector<ParticleFrame> frame_;
};

}  // namespace swage
