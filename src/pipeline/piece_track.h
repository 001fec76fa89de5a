// SPDX-License-Identifier: GPL-3.0-or-later
// Which pieces of a body each skin of a run shows, so numbered that a piece keeps its number from
// frame to frame.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "pipeline/frame_store.h"

namespace swage {

// The pieces of a body in that frame, in the order of their numbers: of each a triangle of every
// shell of its skin, the largest shell first. None: the body is one piece.
struct NamedPieces {
    int frame = 0;
    std::vector<std::vector<int>> triangle;
};

// A body is one piece as it starts, of however many shells its skin is, until something comes off
// it. Pieces are numbered as they are in the last frame, the heaviest first: as that is told or,
// where it is not, by volume, each shell that came off as a piece. Those that are not there any
// more, since shells were joined again, come after. Where a shell comes apart the number stays with
// the part that the first of what becomes of it is from. A piece of several shells has its number
// from where the first of them came off, and all of them are until then what that was part of.
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
    using Shells = std::vector<int>;
    static std::vector<Shells> shells_of(const NamedPieces& told, const Components& shells);
    static std::size_t first_parted(const std::vector<Step>& steps);
    void number(std::size_t body, std::vector<Step>& steps, std::vector<Shells> told);
    static void number_piece(std::vector<Step>& steps, std::size_t last, const Shells& shells,
                             std::optional<std::size_t> from, std::vector<int>& first_frame);

    std::map<std::pair<std::size_t, int>, std::vector<int>> of_shell_;  // of a body's skin
    std::vector<std::vector<int>> first_frame_;                         // of each piece
};

}  // namespace swage
