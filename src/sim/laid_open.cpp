// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/laid_open.h"

#include <algorithm>
#include <unordered_map>

#include "matter/open_faces.h"

namespace swage {

std::vector<OpenFace> laid_open(const Aggregate& matter) {
    const std::vector<char> whole = whole_cells(matter);
    std::vector<OpenFace> faces;
    if (std::find(whole.begin(), whole.end(), 0) == whole.end()) return faces;
    // Of cells with an open face, by their lowest corner: sum of the surface's area vectors [m2].
    std::unordered_map<ParticleId, Vec3> surface_in;
    for_each_open_face(matter.lattice, whole, [&](const CellRun& run, int n, int) {
        surface_in.try_emplace(run.row[0] + n, Vec3::Zero());
    });
    const SurfacePoints& surface = matter.surface;
    for (std::size_t p = 0; p < surface.size(); ++p) {
        if (surface.is_loose(p)) continue;
        const auto at = surface_in.find(surface.row(p)[0]);
        if (at != surface_in.end()) at->second += surface.area(p) * surface.normal(p);
    }
    const double a2 = matter.lattice.spacing * matter.lattice.spacing;
    for_each_open_face(matter.lattice, whole, [&](const CellRun& run, int n, int face) {
        const int axis = face >> 1, side = face & 1;
        const double leaning = surface_in.at(run.row[0] + n)[axis] / (2 * a2);
        const double share =
            std::clamp(matter.cell_fill[run.first + n] - (side ? leaning : -leaning), 0.0, 1.0);
        if (share == 0) return;
        const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, low = side << axis;
        const auto corner = [&](int c) { return run.corner(n, c); };
        OpenFace& open = faces.emplace_back();
        open.corner = {corner(low), corner(low | u), corner(low | u | v), corner(low | v)};
        if (side == 0) std::swap(open.corner[1], open.corner[3]);
        open.share = share;
    });
    return faces;
}

}  // namespace swage
