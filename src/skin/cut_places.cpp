// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/cut_places.h"

#include "skin/piece_map.h"

namespace swage {

BladePaths paths_between_particles(const std::vector<std::array<Vec3, 3>>& sweep, const Box& box,
                                   double spacing) {
    BladePaths swept = blade_paths(sweep, box, 1e-3 * spacing);
    for (BladePath& path : swept.path) path.point += spacing * Vec3(1.3e-6, 1.7e-6, 0.9e-6);
    return swept;
}

CornerMask corners_on_side(const Aggregate& matter, CellId cell, const BladePath& path, int own) {
    const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
    CornerMask mask = 0;
    for (int c = 0; c < 8; ++c) {
        const Vec3 at = matter.particle_position.at(corner[c]);
        mask |= static_cast<CornerMask>(path.side(at) == own) << c;
    }
    return mask;
}

void keep_to_sides(Mount& mount, const Aggregate& matter,
                   const std::vector<std::array<Vec3, 3>>& sweep, const Box& box) {
    if (mount.reference.empty()) return;
    const double a = matter.lattice.spacing;
    const BladePaths swept = paths_between_particles(sweep, box, a);
    const PieceMap pieces(matter);
    std::vector<Vec3> world;
    skin_positions(mount, matter, world);
    for (std::size_t v = 0; v < world.size(); ++v) {
        const int place = static_cast<int>(v);
        const int piece = pieces.piece_of(mount.place(place));
        const auto side_in = [&](CellId cell, CornerMask side) {
            for (const BladePath& path : swept.path) {
                if (!path.near(path.flat(world[v]), 2 * a)) continue;
                side &= corners_on_side(matter, cell, path, path.side(world[v]));
            }
            return side;
        };
        CellSide best{mount.cell[v], side_in(mount.cell[v], mount.side[v])};
        if (best.side == 0) {
            best = nearest_side(
                matter, mount.cell[v], mount.reference[v], [&](CellId cell, const Vec3i&) {
                    return side_in(cell, pieces.side_of_piece(cell, mount.reference[v], piece));
                });
        }
        if (best.cell < 0) continue;  // of a sliver without a particle of its own
        mount.cell[v] = best.cell;
        mount.side[v] = best.side;
    }
    finish_mount(mount, matter);
    hold_places(mount, matter, world);
}

}  // namespace swage
