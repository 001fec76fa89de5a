// SPDX-License-Identifier: GPL-3.0-or-later
// Which piece of the matter a place of the body follows, and which corners of a severed cell.
#pragma once

#include <span>

#include "matter/aggregate.h"
#include "skin/carrier.h"

namespace swage {

// `hold` of a place between up to three others: linear in the place.
Vec3 hold_between(const Vec3& reference, std::span<const BodyPlace> others);

// A snapshot: the matter must outlive it, and its connections stay as they are.
class PieceMap {
  public:
    explicit PieceMap(const Aggregate& matter) : matter_(matter), pieces_(find_pieces(matter)) {}

    const Pieces& pieces() const { return pieces_; }
    int piece_of(const BodyPlace& place) const;  // of the particle that weighs most
    // Whether corners of a cell that hang together belong to the piece.
    bool follows(CellId cell, CornerMask group, int piece) const;
    // Corners of the cell that belong to one piece and hang together with the one next to the
    // place; 0: it has none.
    CornerMask side_of_piece(CellId cell, const Vec3& reference, int piece) const;
    // A place between others of one side of every cut: it follows what they do, if need be with a
    // cell beside its own.
    BodyPlace beside(const Vec3& reference, std::span<const BodyPlace> others) const;

  private:
    const Aggregate& matter_;
    Pieces pieces_;
};

}  // namespace swage
