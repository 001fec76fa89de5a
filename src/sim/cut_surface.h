// SPDX-License-Identifier: GPL-3.0-or-later
// How deep a place of a body lies below where it has been cut or broken. Cells beside the path of a
// blade know its planes, and go by the nearest, or how it bends (sim/bent_faces.h). Where a load
// broke the matter the new surface runs half a cell before the faces that look at cells no longer
// whole: corners of such faces lie half a cell deep, others by their distance to these or to the
// path of a blade deeper, and between corners depth is interpolated, and goes on before the faces.
// So it is a continuous function of the place, and flat where a cut is flat, however that stands to
// the lattice. Each side's own corners are the nearest: faces of the other side do not count. All
// lengths in spacings, all places in cells.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "matter/cut_planes.h"
#include "sim/bent_faces.h"
#include "sim/rest_surface.h"

namespace swage {

class CutSurface {
  public:
    struct Plane {
        Vec3 normal;   // outward
        double depth;  // of the cell's low corner, less than zero inside
    };

    CutSurface(const Aggregate& matter, const std::vector<char>& is_whole);
    // Of the planes that end each cell.
    explicit CutSurface(std::vector<std::vector<Plane>> planes);

    // Of a whole cell that is rim: within two and a half spacings. What looks the other way than
    // `met`, where that is not zero, does not count.
    RestSurface::Depth at(CellId cell, const Vec3& place, const Vec3& met = Vec3::Zero()) const;
    static bool is_opposed(const Vec3& normal, const Vec3& met) { return normal.dot(met) < -0.3; }
    bool is_rim(CellId cell) const { return slot_[cell] >= 0; }
    // How far outside of a whole cell the surface may lie: before cuts farther than before breaks.
    double beyond(CellId cell) const {
        const int slot = slot_[cell];
        return slot >= 0 && (!plane_[slot].empty() || bent_of_[slot] >= 0) ? kBeforeCut
                                                                           : kBeforeBreak;
    }
    static constexpr double kBeforeCut = 1, kBeforeBreak = 0.5;
    // Cells that have a new face, in their order.
    const std::vector<CellId>& skin() const { return skin_; }

  private:
    static std::vector<Plane> planes_of(const Vec3i& site, const std::vector<CutPlane>& near);

    std::vector<int> slot_;                     // of each cell, -1: no rim
    std::vector<std::array<float, 8>> corner_;  // by slot; of a cell with planes without these
    std::vector<std::vector<Plane>> plane_;     // by slot
    std::vector<int> bent_of_;                  // by slot, -1: none
    BentFaces bent_;
    std::vector<CellId> skin_;
};

}  // namespace swage
