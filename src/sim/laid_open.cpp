// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/laid_open.h"

#include <algorithm>
#include <unordered_map>

namespace swage {

namespace {

struct Opened {
    CellId cell;
    Vec3i site;
    std::array<ParticleId, 4> row;
    unsigned faces;               // 2 axis + side
    Vec3 surface = Vec3::Zero();  // sum of the area vectors at molding [m2]
};

std::vector<Opened> opened_cells(const Aggregate& matter) {
    const Lattice& lattice = matter.lattice;
    std::vector<char> whole(matter.cell_fill.size(), 1);
    bool all = true;
    const auto row_at = [](const CellRun& run, int n) {
        return std::array<ParticleId, 4>{run.row[0] + n, run.row[1] + n, run.row[2] + n,
                                         run.row[3] + n};
    };
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            whole[run.first + n] = cell_is_whole(matter, row_at(run, n));
            all = all && whole[run.first + n];
        }
    }
    std::vector<Opened> opened;
    if (all) return opened;
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            if (!whole[run.first + n]) continue;
            const Vec3i site(run.i + n, run.j, run.k);
            unsigned faces = 0;
            for (int face = 0; face < 6; ++face) {
                const Vec3i next = site + (face & 1 ? 1 : -1) * Vec3i::Unit(face >> 1);
                const CellId other = lattice.cell_at(next.x(), next.y(), next.z());
                if (other >= 0 && !whole[other]) faces |= 1u << face;
            }
            if (faces != 0) opened.push_back({run.first + n, site, row_at(run, n), faces});
        }
    }
    return opened;
}

}  // namespace

std::vector<OpenFace> laid_open(const Aggregate& matter) {
    std::vector<Opened> opened = opened_cells(matter);
    std::unordered_map<ParticleId, std::size_t> by_low_corner;  // looked up only
    for (std::size_t n = 0; n < opened.size(); ++n) by_low_corner[opened[n].row[0]] = n;
    const SurfacePoints& surface = matter.surface;
    for (std::size_t p = 0; p < surface.size() && !opened.empty(); ++p) {
        if (surface.is_loose(p)) continue;
        const auto at = by_low_corner.find(surface.row(p)[0]);
        if (at != by_low_corner.end()) {
            opened[at->second].surface += surface.area(p) * surface.normal(p);
        }
    }
    const double a2 = matter.lattice.spacing * matter.lattice.spacing;
    std::vector<OpenFace> faces;
    for (const Opened& cell : opened) {
        const auto corner = [&](int c) { return cell.row[c >> 1] + (c & 1); };
        for (int face = 0; face < 6; ++face) {
            if (!(cell.faces >> face & 1)) continue;
            const int axis = face >> 1, side = face & 1;
            const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, low = side << axis;
            const double share = std::clamp(
                matter.cell_fill[cell.cell] - (side ? 0.5 : -0.5) * cell.surface[axis] / a2, 0.0,
                1.0);
            if (share == 0) continue;
            OpenFace& open = faces.emplace_back();
            open.corner = {corner(low), corner(low | u), corner(low | u | v), corner(low | v)};
            if (side == 0) std::swap(open.corner[1], open.corner[3]);
            open.share = share;
            open.area = share * a2;
        }
    }
    return faces;
}

}  // namespace swage
