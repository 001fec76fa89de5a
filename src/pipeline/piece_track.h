// SPDX-License-Identifier: GPL-3.0-or-later
// Which pieces of a body each skin of a run shows, so numbered that a piece keeps its number from
// frame to frame.
#pragma once

#include <map>
#include <vector>

#include "pipeline/frame_store.h"

namespace swage {

// A body is one piece as it starts, of however many shells its skin is. Where a shell comes apart
// the largest part, by area, keeps the number, and the others have the next ones; where shells are
// joined again the number is that of the larger.
class PieceTrack {
  public:
    // Goes over all frames. Throws Interrupted.
    explicit PieceTrack(const FrameStore& store);

    int count(std::size_t body) const { return static_cast<int>(first_frame_.at(body).size()); }
    // That a piece of it comes in.
    int first_frame(std::size_t body, int piece) const { return first_frame_.at(body).at(piece); }
    // Of each triangle of the body's skin, from 0 on.
    std::vector<int> of_triangles(std::size_t body, int skin, const TriMesh& mesh) const;

  private:
    struct Skin;
    static std::vector<int> parents(const Skin& now, const Skin& before);
    static void number_shells(Skin& now, const Skin& before, int frame,
                              std::vector<int>& first_frame);

    std::map<std::pair<std::size_t, int>, std::vector<int>> of_shell_;  // of a body's skin
    std::vector<std::vector<int>> first_frame_;                         // of each piece
};

}  // namespace swage
