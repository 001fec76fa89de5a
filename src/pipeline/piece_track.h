// SPDX-License-Identifier: GPL-3.0-or-later
// Which pieces of a body each skin of a run shows, so numbered that a piece keeps its number from
// frame to frame.
#pragma once

#include <map>
#include <vector>

#include "pipeline/frame_store.h"

namespace swage {

// A triangle of each piece of a body's skin in that frame, in the order of their numbers.
struct NamedPieces {
    int frame = 0;
    std::vector<int> triangle;
};

// A body is one piece as it starts, of however many shells its skin is. Pieces are numbered as they
// are in the last frame, the heaviest first: as that is told or, where it is not, by volume. Those
// that are not there any more, since shells were joined again, come after. Where a shell comes
// apart the number stays with the part that the first of what becomes of it is from.
class PieceTrack {
  public:
    // Goes over all frames. `told`: of each body, in the last frame. Throws Interrupted.
    explicit PieceTrack(const FrameStore& store, const std::vector<NamedPieces>& told = {});

    int count(std::size_t body) const { return static_cast<int>(first_frame_.at(body).size()); }
    // That a piece of it comes in.
    int first_frame(std::size_t body, int piece) const { return first_frame_.at(body).at(piece); }
    // Of each triangle of the body's skin, from 0 on.
    std::vector<int> of_triangles(std::size_t body, int skin, const TriMesh& mesh) const;

  private:
    struct Skin;
    struct Step;
    void number(std::size_t body, std::vector<Step>& steps, std::vector<int> first);

    std::map<std::pair<std::size_t, int>, std::vector<int>> of_shell_;  // of a body's skin
    std::vector<std::vector<int>> first_frame_;                         // of each piece
};

}  // namespace swage
