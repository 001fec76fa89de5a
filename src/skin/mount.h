// SPDX-License-Identifier: GPL-3.0-or-later
// Mounting (S2.11): every vertex of a mesh is bound, at molding, to the particles around it, and
// follows them from then on.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "skin/carrier.h"
#include "skin/settings.h"

namespace swage {

// Vertices in the order of the mesh. `reference`, `cell`, `side` and `hold` say everything; the
// rest is derived from them by finish_mount.
struct Mount {
    SkinKind kind = SkinKind::mount;
    std::vector<Vec3> reference;   // at molding [m]
    std::vector<CellId> cell;      // that carries the vertex
    std::vector<CornerMask> side;  // corners that it follows once the cell is severed
    // How far it lies off where these have it, in the axes of what carries it [m]. What is left of
    // a cell that a blade has severed has its places elsewhere than all of it did, where the matter
    // has flowed unevenly. What is strained elastically comes back, and its places with it.
    std::vector<Vec3> hold;

    BodyPlace place(int v) const { return {reference[v], cell[v], side[v], hold[v]}; }
    // One vertex more, at the end.
    void add(const BodyPlace& place) {
        reference.push_back(place.reference);
        cell.push_back(place.cell);
        side.push_back(place.side);
        hold.push_back(place.hold);
    }

    // Vertices of one cell together, so that its frames are read once.
    struct CellGroup {
        CellId cell;
        int first, count;           // into vertex, carrier
        std::array<int, 8> corner;  // into particle
    };
    std::vector<CellGroup> group;
    std::vector<int> vertex;
    std::vector<Carrier> carrier;
    std::vector<ParticleId> particle;  // that carry vertices, ascending
    FrameStencil stencil;
};

// Binds places of the body at molding. The matter may be deformed already: only its lattice and its
// reference positions count. Places outside every active cell are carried by the nearest one.
Mount mount_mesh(const std::vector<Vec3>& reference, const Aggregate& matter, SkinKind kind);

// To be called after reference, cell or side were changed.
void finish_mount(Mount& mount, const Aggregate& matter);

// Where the vertices are now [m]. With the matter at rest they are the reference to the bit; a
// rigid motion is followed exactly; in severed cells each vertex follows the matter on its side.
void skin_positions(const Mount& mount, const Aggregate& matter, std::vector<Vec3>& position);

// With the matter where it is now, the vertices are at `place` and follow it from there, where
// anything has flowed. To be called when cells, sides or connections were changed. Cells that broke
// by load are left out: their vertices part only then.
void hold_places(Mount& mount, const Aggregate& matter, const std::vector<Vec3>& place);

}  // namespace swage
