// SPDX-License-Identifier: GPL-3.0-or-later
// Which pieces of a body each grip really holds. A point of the surface stands on a cell; where a
// cut or a crack has parted that, it holds the piece on its side, by what carries it there
// (sim/torn_forces.h), or none.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"

namespace swage {

struct GrippedPieces {
    static constexpr int kNone = -1, kSeveral = -2;

    Pieces pieces;
    // Of each grip, by its points: the piece; kNone: let go.
    std::vector<std::vector<int>> at;
    // Of each piece: the grip that alone holds it, and in every way; kSeveral: held otherwise.
    std::vector<int> by;
    std::vector<char> firm;  // of each piece: in a grip that holds it in every way

    template <typename Io>
    void visit(Io& io) {
        io(pieces, at, by, firm);
    }

    bool is_held(int piece) const { return by[std::size_t(piece)] != kNone; }
};

// Of the only body that the apparatus' grips hold.
GrippedPieces find_gripped_pieces(const Aggregate& matter, const Apparatus& apparatus);

}  // namespace swage
