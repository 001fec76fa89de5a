// SPDX-License-Identifier: GPL-3.0-or-later
// Where the cells of a mold lie: the map between the mesh's space and bins. Each cell is two bins
// wide along every axis, so that its surface can be told in quarters of a face.
#pragma once

#include "geometry/box.h"
#include "geometry/trimesh.h"

namespace swage {

struct MoldFrame {
    Vec3 origin;       // low corner of cell (0, 0, 0) [m]
    Vec3i cell_count;  // of the box
    // What the mesh has in a cell's place [m]: along an axis that holds a whole number of cells but
    // for what files round off, as much as makes the faces of a box lie exactly on cell faces.
    Vec3 step;
    // Of the matter's cells [m], which are cubes of that volume, or they would be strained; they
    // stand about the same middle.
    double spacing;
    Vec3 lattice_origin() const {
        return origin +
               0.5 * cell_count.cast<double>().cwiseProduct(step - Vec3::Constant(spacing));
    }
    double cell_volume() const { return step.prod(); }

    // In bins, 0 to twice cell_count in the box; whole when within 1e-9 of it, on the box's side
    // when less than 1e-6 beyond it.
    Vec3 bins(const Vec3& point) const;
    Vec3 point(const Vec3& bins) const { return origin + bins.cwiseProduct(0.5 * step); }
};

// Whole cells over the box, centred on it; as many for what differs from it by 0.003 cells. The
// counts must fit into int.
MoldFrame frame_over(const Box& box, double spacing);

// Cells over each side, before anything is allocated; may be too many for int.
Vec3 cells_over(const Box& box, double spacing);

}  // namespace swage
