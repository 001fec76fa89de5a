// SPDX-License-Identifier: GPL-3.0-or-later
// NOTE: a point stands at the centre of its patch, so the points nearest an edge of the body lie a
// quarter of a spacing inside it. The area's integral and first moments are exact; a tool that
// meets only an edge is met that much later.
#include "mold/surface.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 2048;  // patches
// How far from its carrier a point may lie, in cells. Farther ones are drawn in: the weights would
// grow and with them the stiffness that contact puts on the carrier's far corners.
constexpr double kOverhang = 0.25;
constexpr double kReach = 0.5;  // of a firm cell, in cells, for points of one that is not

double distance_squared(const Vec3& point, const Vec3i& cell) {
    const Vec3 low = cell.cast<double>();
    return (point - point.cwiseMax(low).cwiseMin(low + Vec3::Ones())).squaredNorm();
}

// The active cell nearest to a point given in cells; `home` is where it would be.
CellId nearest_cell(const Lattice& lattice, const Vec3i& home, const Vec3& point) {
    CellId best = -1;
    double best_distance = 0;
    const auto consider = [&](CellId cell, const Vec3i& site) {
        const double d = distance_squared(point, site);
        if (best < 0 || d < best_distance) best = cell, best_distance = d;
    };
    constexpr int kRings = 3;
    for (int ring = 1; ring <= kRings; ++ring) {
        // Cells of this ring are at least ring - 1 away.
        if (best >= 0 && best_distance <= (ring - 1.0) * (ring - 1.0)) break;
        for (int dk = -ring; dk <= ring; ++dk) {
            for (int dj = -ring; dj <= ring; ++dj) {
                const bool inner = std::max(std::abs(dk), std::abs(dj)) < ring;
                for (int di = -ring; di <= ring; di += inner ? 2 * ring : 1) {
                    const Vec3i site = home + Vec3i(di, dj, dk);
                    const CellId cell = lattice.cell_at(site);
                    if (cell >= 0) consider(cell, site);
                }
            }
        }
    }
    if (best >= 0) return best;
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) consider(run.first + n, {run.i + n, run.j, run.k});
    }
    return best;
}

// Who carries a point whose own cell is not firm: the nearest firm cell within reach, the fuller of
// two that are equally near; where none is, the fullest. -1: there is no cell within reach.
CellId firm_cell(const Lattice& lattice, const std::vector<float>& fill, const Vec3i& home,
                 const Vec3& point) {
    CellId best = -1;
    double best_distance = 0;
    lattice.for_each_cell_around(home, [&](CellId cell, const Vec3i& site) {
        const double d = distance_squared(point, site);
        if (d >= kReach * kReach) return;
        const auto better = [&] {
            if (best < 0) return true;
            const bool firm = fill[cell] >= kFirmFill, best_firm = fill[best] >= kFirmFill;
            if (firm != best_firm) return firm;
            if (firm && d != best_distance) return d < best_distance;
            return fill[cell] > fill[best];
        };
        if (better()) best = cell, best_distance = d;
    });
    return best;
}

}  // namespace

SurfacePoints carry_patches(const std::vector<CellLayer>& layers, const Lattice& lattice,
                            const std::vector<float>& fill) {
    struct Chunk {
        int k;
        std::size_t begin, end, first;  // patches of the layer; the first's number in all
    };
    std::vector<Chunk> chunks;
    std::size_t count = 0;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        const std::size_t patches = layers[k].patch.size();
        for (std::size_t begin = 0; begin < patches; begin += kChunk) {
            const std::size_t end = std::min(patches, begin + kChunk);
            chunks.push_back({static_cast<int>(k), begin, end, count});
            count += end - begin;
        }
    }
    SurfacePoints surface;
    surface.resize(count);
    parallel_for(chunks.size(), [&](std::size_t c) {
        const Chunk& chunk = chunks[c];
        for (std::size_t n = chunk.begin; n < chunk.end; ++n) {
            const SurfacePatch& patch = layers[chunk.k].patch[n];
            const std::size_t p = chunk.first + n - chunk.begin;
            const Vec3 point = 0.5 * patch.center;
            Vec3i site(patch.i, patch.j, chunk.k);
            CellId cell = lattice.cell_at(site);
            double overhang = kOverhang;
            if (cell < 0 || fill[cell] < kFirmFill) {
                const CellId firm = firm_cell(lattice, fill, site, point);
                if (firm >= 0) {
                    cell = firm;
                    overhang = kReach;
                } else if (cell < 0) {
                    cell = nearest_cell(lattice, site, point);
                }
                site = lattice.cell_site(cell);
            }
            const Vec3 free = point - site.cast<double>();
            const Vec3 local = free.cwiseMax(-overhang).cwiseMin(1 + overhang);
            surface.set(p, lattice.cell_row(cell), local, patch.area, patch.normal);
        }
    });
    return surface;
}

}  // namespace swage
