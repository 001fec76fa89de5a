// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_volume.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "laws/cell.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kRunsPerChunk = 256;

// Component, row: position of the row's low end in the first cell.
struct CellRows {
    const double* at[3][4];
};

SWAGE_VECTOR_CLONES
void volume_block(const CellRows& rows, int count, double scale, double* __restrict volume) {
    for (int n = 0; n < count; ++n) {
        double f[3][3];
        for (int i = 0; i < 3; ++i) {
            const double* const* r = rows.at[i];
            const double a0 = r[0][n], a1 = r[0][n + 1], b0 = r[1][n], b1 = r[1][n + 1];
            const double c0 = r[2][n], c1 = r[2][n + 1], d0 = r[3][n], d1 = r[3][n + 1];
            f[i][0] = scale * ((a1 - a0) + (b1 - b0) + (c1 - c0) + (d1 - d0));
            f[i][1] = scale * ((b0 - a0) + (b1 - a1) + (d0 - c0) + (d1 - c1));
            f[i][2] = scale * ((c0 - a0) + (c1 - a1) + (d0 - b0) + (d1 - b1));
        }
        volume[n] = f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) -
                    f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0]) +
                    f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
    }
}

// Whether a cell's law looks at it from its middle.
bool is_centred(const Aggregate& matter, CellId cell) {
    return matter.material.mechanics == Mechanics::springs || matter.cell_centroid[cell].isZero(0);
}

}  // namespace

void add_cells_below(const Aggregate& matter, const CellRun& run, double limit,
                     std::vector<SmallCell>& found) {
    double volume[kCellBlock];
    for (int at = 0; at < run.count; at += kCellBlock) {
        const int count = std::min(kCellBlock, run.count - at);
        cell_volumes(matter, run, at, count, volume);
        for (int n = 0; n < count; ++n) {
            if (!is_centred(matter, run.first + at + n)) {
                volume[n] = material_gradient(matter, run, at + n).determinant();
            }
            if (!(volume[n] < limit)) continue;
            std::array<ParticleId, 4> row = run.row;
            for (ParticleId& p : row) p += at + n;
            if (!cell_is_sound(matter, run.first + at + n, row)) continue;
            found.push_back({&run, at + n, volume[n]});
        }
    }
}

std::vector<SmallCell> cells_below(const Aggregate& matter, double limit) {
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const std::size_t chunks = (runs.size() + kRunsPerChunk - 1) / kRunsPerChunk;
    std::vector<std::vector<SmallCell>> part(chunks);
    parallel_for(chunks, [&](std::size_t chunk) {
        const std::size_t end = std::min(runs.size(), (chunk + 1) * kRunsPerChunk);
        for (std::size_t r = chunk * kRunsPerChunk; r < end; ++r) {
            add_cells_below(matter, runs[r], limit, part[chunk]);
        }
    });
    std::vector<SmallCell> found;
    for (const auto& p : part) found.insert(found.end(), p.begin(), p.end());
    return found;
}

void cell_volumes(const Aggregate& matter, const CellRun& run, int at, int count, double* volume) {
    CellRows rows;
    for (int q = 0; q < 4; ++q) {
        rows.at[0][q] = matter.particle_position.x.data() + run.row[q] + at;
        rows.at[1][q] = matter.particle_position.y.data() + run.row[q] + at;
        rows.at[2][q] = matter.particle_position.z.data() + run.row[q] + at;
    }
    volume_block(rows, count, 0.25 / matter.lattice.spacing, volume);
}

Mat3 cell_gradient(const Aggregate& matter, const CellRun& run, int n) {
    Mat3 gradient = Mat3::Zero();
    for (int c = 0; c < 8; ++c) {
        const Vec3 x = matter.particle_position.at(run.row[c >> 1] + n + (c & 1));
        for (int axis = 0; axis < 3; ++axis) {
            gradient.col(axis) += (c >> axis & 1 ? 0.25 : -0.25) / matter.lattice.spacing * x;
        }
    }
    return gradient;
}

CornerSums<double> corner_sums(const Aggregate& matter, const CellRun& run, int n) {
    CornerSums<double> c;
    double v[8];
    const auto component = [&](const std::vector<double>& x) -> const double(&)[8] {
        for (int q = 0; q < 8; ++q) v[q] = x[run.row[q >> 1] + n + (q & 1)];
        return v;
    };
    const Vec3Array& x = matter.particle_position;
    sum_corners(component(x.x), c.x.x, c.y.x, c.z.x, c.xy.x, c.yz.x, c.zx.x, c.xyz.x);
    sum_corners(component(x.y), c.x.y, c.y.y, c.z.y, c.xy.y, c.yz.y, c.zx.y, c.xyz.y);
    sum_corners(component(x.z), c.x.z, c.y.z, c.z.z, c.xy.z, c.yz.z, c.zx.z, c.xyz.z);
    return c;
}

Triple<double> material_place(const Aggregate& matter, CellId cell) {
    if (is_centred(matter, cell)) return {0, 0, 0};
    const Vec3 at = 2 * matter.cell_centroid[cell].cast<double>();
    return {at.x(), at.y(), at.z()};
}

Mat3 matrix_of(const Columns<double>& f) {
    Mat3 m;
    m << f.x.x, f.y.x, f.z.x, f.x.y, f.y.y, f.z.y, f.x.z, f.y.z, f.z.z;
    return m;
}

Mat3 material_gradient(const Aggregate& matter, const CellRun& run, int n) {
    return matrix_of(centroid_gradient(corner_sums(matter, run, n),
                                       material_place(matter, run.first + n),
                                       matter.lattice.spacing));
}

CellId first_inside_out(const Aggregate& matter) {
    const std::vector<SmallCell> found = cells_below(matter, 0);
    return found.empty() ? -1 : found[0].id();
}

double smallest_cell_volume(const Aggregate& matter) {
    double smallest = 1;
    for (const SmallCell& cell : cells_below(matter, 1.0)) {
        if (matter.cell_fill[cell.id()] < 0.25f) continue;
        smallest = std::min(smallest, cell.volume);
    }
    return smallest;
}

}  // namespace swage
