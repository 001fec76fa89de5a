// SPDX-License-Identifier: GPL-3.0-or-later
// Which parts of a surface hang together nearby. Matter whose surfaces do is joined there, and
// matter whose surfaces do not is apart, for a closed surface cuts a box into what lies on its
// either side.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/trimesh.h"
#include "mold/frame.h"

namespace swage {

struct CellPart;

bool comes_before(const Vec3i& a, const Vec3i& b);  // of cells: by z, y, x

// What of a piece of surface faces about one way.
struct FacingPatch {
    int piece;
    Vec3 center;  // [cells]
    Vec3 normal;  // unit, outward
    double area;  // [m2]
};

class SurfacePieces {
  public:
    // Of the surface in these cells, sorted. A piece is what hangs together in one cell.
    SurfacePieces(const TriMesh& mesh, const MoldFrame& frame, const std::vector<Vec3i>& cells);

    const std::vector<FacingPatch>& patches() const { return patch_; }  // sorted by cell
    const Vec3i& cell_of(const FacingPatch& patch) const {
        return cells_[cell_of_piece_[patch.piece]];
    }

    std::size_t count() const { return cell_of_piece_.size(); }
    // In other cells.
    const std::vector<int>& next_to(int piece) const { return next_[piece]; }
    // Those that hang together with a piece, which is the first, by what lies in its cell and those
    // around.
    std::vector<int> joined_around(int piece) const;

  private:
    // A triangle or an edge, and what it belongs to in a cell.
    struct Element {
        std::uint64_t key;
        int piece;
    };

    void add_cell(const TriMesh& mesh, const std::vector<Vec3>& at, const CellPart* first,
                  const CellPart* last, int cell);
    void link_neighbours();

    std::vector<Vec3i> cells_;
    std::vector<Element> element_;
    std::vector<std::size_t> first_element_;  // of each cell, and the end
    std::vector<int> cell_of_piece_;
    std::vector<std::vector<int>> next_;  // of each piece, in other cells
    std::vector<FacingPatch> patch_;
};

}  // namespace swage
