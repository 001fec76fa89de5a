// SPDX-License-Identifier: GPL-3.0-or-later
// How deep a place lies below the path of a blade that bends (matter/bent_path.h): from how deep
// the corners of the cell around it lie, and how that rises there,
//
//     d(p) = sum_c w_c (d_c + g_c . (p - c) / 2)        w_c: trilinear
//
// What is interpolated from d_c is as much too great as what goes on along g_c is too small where
// it bends evenly. Cells that the path goes through tell it too: a whole cell asks them about what
// lies before it. So it is one function of the place, whichever cell is asked, and the same for
// what lies on either side, but for the sign.
// All lengths in spacings.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "matter/cut_planes.h"
#include "sim/rest_surface.h"

namespace swage {

// The paths of blades as corners of cells see them.
class PathsAtCorners {
  public:
    explicit PathsAtCorners(const CutPlanes& cuts) : cuts_(&cuts) {}
    std::array<const std::vector<CutPlane>*, 8> of(const Vec3i& site);

  private:
    const CutPlanes* cuts_;
    std::unordered_map<std::uint64_t, std::vector<CutPlane>> seen_;  // looked up only
};

class BentFaces {
  public:
    // Of a whole cell what goes on from those that come near it; its number, or -1: there is none,
    // as where one would go through the cell.
    int add(const Vec3i& site, const std::vector<CutPlane>& near, PathsAtCorners& paths);
    // When all have been added: the cells beside them that are not whole.
    void add_beside(const Lattice& lattice, const std::vector<char>& is_whole,
                    PathsAtCorners& paths);
    // Of a cell by its number; the nearest.
    SurfaceDepth at(int number, const Vec3& place) const;

  private:
    struct Face {
        std::array<double, 8> depth{};
        std::array<Vec3, 8> slope;
        int known = 0;  // corners, a bit each

        SurfaceDepth at(const Vec3& place) const;
    };
    using Faces = std::vector<Face>;
    Faces faces_of(const Vec3i& site, const std::vector<CutPlane>* near, PathsAtCorners& paths);

    std::vector<Faces> face_;                  // of whole cells, then of those beside
    std::vector<Vec3i> site_;                  // of whole cells
    std::vector<std::array<int, 27>> beside_;  // of each its neighbours', -1: none
};

}  // namespace swage
