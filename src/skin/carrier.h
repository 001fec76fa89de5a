// SPDX-License-Identifier: GPL-3.0-or-later
// How a place of the body at molding is carried by the eight particles of a cell.
#pragma once

#include <limits>

#include "matter/cell_parts.h"
#include "skin/particle_frames.h"

namespace swage {

// A place of the body at molding, with the cell and the corners that it follows.
struct BodyPlace {
    Vec3 reference = Vec3::Zero();
    CellId cell = -1;
    CornerMask side = kAllCorners;
    Vec3 hold = Vec3::Zero();  // as Mount has it
};

// The frames of a cell's corners, a column each, and the cell's size at molding.
struct CellFrames {
    Eigen::Matrix<double, 12, 8> corner;
    Vec3 size;
};

// A place in or near a cell. Beyond the cell, `local` stops at its face and `arm` goes on.
struct Carrier {
    Vec3 local;  // in the cell, 0 to 1 along each axis
    Vec3 arm;    // from the cell's low corner: the place, less half of the way to `local` [m]
};

// Low corner and size of a cell at molding [m].
struct CellBox {
    Vec3 low, size;
};
CellBox cell_box(const Aggregate& matter, CellId cell);

// The active cell that holds the place (at molding), or the nearest one.
CellId carrying_cell(const Aggregate& matter, const Vec3& place);
Carrier carrier_in(const CellBox& box, const Vec3& place);

// Of the cells at and around `home` the nearest to the place (at molding) in which
// side_in(cell, site) has a corner, and what it is there. `cell` -1: there is none.
struct CellSide {
    CellId cell = -1;
    CornerMask side = 0;
};
template <typename SideIn>
CellSide nearest_side(const Aggregate& matter, CellId home, const Vec3& place,
                      const SideIn& side_in) {
    CellSide best;
    double least = std::numeric_limits<double>::infinity();
    const auto offer = [&](CellId cell, const Vec3i& site) {
        const CornerMask side = side_in(cell, site);
        const CellBox box = cell_box(matter, cell);
        const Vec3 nearest = place.cwiseMax(box.low).cwiseMin(box.low + box.size);
        const double distance = (place - nearest).norm();
        if (side != 0 && distance < least) least = distance, best = {cell, side};
    };
    matter.lattice.for_each_cell_around(matter.lattice.cell_site(home), offer);
    return best;
}

// The corners that a place follows: all of them in a whole cell, else those of `side` that hang
// together with the one of `side` that weighs most.
CornerMask followed_corners(const CornerGroups& groups, CornerMask side, const Vec3& local);

// What carries one place.
struct Carriage {
    std::array<ParticleId, 8> corner;
    Carrier at;
    CornerMask followed;
};
Carriage carriage_of(const Aggregate& matter, const BodyPlace& place);

// Displacement [m] in a whole cell: sum N_c (u_c + 1/2 G_c (X - X_c)), exact for quadratic fields
// when the frames are. `half` is made once a cell.
CellFrames half_frames(const CellFrames& cell);
void whole_displacements(const CellFrames& half, const Carrier* carrier, int count, Vec3* moved);
inline Vec3 whole_displacement(const CellFrames& half, const Carrier& carrier) {
    Vec3 moved;
    whole_displacements(half, &carrier, 1, &moved);
    return moved;
}

// In a severed cell: the weighted mean of what each followed corner's affine frame says.
Vec3 part_displacement(const CellFrames& cell, const Carrier& carrier, CornerMask followed);

// Mean deformation gradient of the corners.
Mat3 mean_slope(const CellFrames& cell, CornerMask corners);

}  // namespace swage
