// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_volume.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "laws/cell_moduli.h"
#include "laws/volume_guard.h"
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

struct SmallCell {
    const CellRun* run;
    int n;
    double volume;
};

// Of a run: sound cells below a volume ratio, in their order.
void add_cells_below(const Aggregate& matter, const CellRun& run, double limit,
                     std::vector<SmallCell>& found) {
    double volume[kCellBlock];
    for (int at = 0; at < run.count; at += kCellBlock) {
        const int count = std::min(kCellBlock, run.count - at);
        cell_volumes(matter, run, at, count, volume);
        for (int n = 0; n < count; ++n) {
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

CellId id_of(const SmallCell& cell) { return cell.run->first + cell.n; }

GuardModuli guard_moduli(const Aggregate& matter, const SmallCell& cell) {
    const Material& m = matter.material_of(id_of(cell));
    const double nu = m.mechanics == Mechanics::springs ? 0.25 : m.poisson_ratio;
    const CellModuli law = cell_moduli(m.young_modulus, nu, matter.lattice.spacing);
    return {m.young_modulus, law.shear, law.bulk,
            m.mechanics == Mechanics::cells && m.elasticity != Elasticity::neo_hookean};
}

double material_volume(const Aggregate& matter, const SmallCell& cell) {
    const double a = matter.lattice.spacing;
    return matter.cell_fill[cell.run->first + cell.n] * a * a * a;
}

// Their forces; returns how many are inside out.
int resist(const Aggregate& matter, const std::vector<SmallCell>& crushed, Vec3Array& force) {
    int mirrored = 0;
    for (const SmallCell& cell : crushed) {
        mirrored += cell.volume < 0;
        const Mat3 stress =
            material_volume(matter, cell) *
            guard_cell(guard_moduli(matter, cell), cell_gradient(matter, *cell.run, cell.n)).stress;
        for (int c = 0; c < 8; ++c) {
            Vec3 slope;  // of the gradient's columns with the corner's position
            for (int axis = 0; axis < 3; ++axis) {
                slope[axis] = (c >> axis & 1 ? 0.25 : -0.25) / matter.lattice.spacing;
            }
            force.add(cell.run->row[c >> 1] + cell.n + (c & 1), -(stress * slope));
        }
    }
    return mirrored;
}

}  // namespace

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

int add_guard_forces(const Aggregate& matter, Vec3Array& force) {
    return resist(matter, cells_below(matter, kGuardedVolume), force);
}

int add_guard_forces(const Aggregate& matter,
                     const std::vector<std::vector<const CellRun*>>& crushed, Vec3Array& force) {
    std::vector<SmallCell> found;
    for (const std::vector<const CellRun*>& part : crushed) {
        for (const CellRun* run : part) add_cells_below(matter, *run, kGuardedVolume, found);
    }
    return resist(matter, found, force);
}

// NOTE: what the guard's law gives back to matter that was turned inside out is ten times what
// would tear it apart, so it is taken on the way.
double calm_crushed(Aggregate& matter, double keep) {
    double taken = 0;
    for (const SmallCell& cell : cells_below(matter, kGuardedVolume)) {
        std::array<std::size_t, 8> p;
        double mass = 0;
        Vec3 center = Vec3::Zero(), drift = Vec3::Zero();
        for (int c = 0; c < 8; ++c) {
            p[c] = static_cast<std::size_t>(cell.run->row[c >> 1] + cell.n + (c & 1));
            const double m = matter.particle_mass[p[c]];
            mass += m;
            center += m * matter.particle_position.at(p[c]);
            drift += m * matter.particle_velocity.at(p[c]);
        }
        center /= mass;
        drift /= mass;
        Mat3 inertia = Mat3::Zero();
        Vec3 spin = Vec3::Zero();
        for (std::size_t q : p) {
            const Vec3 r = matter.particle_position.at(q) - center;
            inertia +=
                matter.particle_mass[q] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
            spin += matter.particle_mass[q] * r.cross(matter.particle_velocity.at(q));
        }
        const double trace = inertia.trace();
        if (!(trace > 0) || !std::isfinite(trace)) continue;
        inertia.diagonal().array() += 1e-12 * trace;
        const Vec3 turn = inertia.ldlt().solve(spin);
        for (std::size_t q : p) {
            const Vec3 rigid = drift + turn.cross(matter.particle_position.at(q) - center);
            const Vec3 v = matter.particle_velocity.at(q), calmed = rigid + keep * (v - rigid);
            taken += 0.5 * matter.particle_mass[q] * (v.squaredNorm() - calmed.squaredNorm());
            matter.particle_velocity.set(q, calmed);
        }
    }
    return taken;
}

CellId first_inside_out(const Aggregate& matter) {
    const std::vector<SmallCell> found = cells_below(matter, 0);
    return found.empty() ? -1 : id_of(found[0]);
}

void add_guard_stiffness(const Aggregate& matter, std::vector<double>& stiffness) {
    for (const SmallCell& cell : cells_below(matter, 0)) {
        const double own = material_volume(matter, cell) *
                           guard_stiffness(guard_moduli(matter, cell)) /
                           (2 * matter.lattice.spacing * matter.lattice.spacing);
        for (int c = 0; c < 8; ++c) stiffness[cell.run->row[c >> 1] + cell.n + (c & 1)] += own;
    }
}

double guard_energy_of(const Aggregate& matter) {
    double sum = 0;
    for (const SmallCell& cell : cells_below(matter, kGuardedVolume)) {
        sum +=
            material_volume(matter, cell) *
            guard_cell(guard_moduli(matter, cell), cell_gradient(matter, *cell.run, cell.n)).energy;
    }
    return sum;
}

double smallest_cell_volume(const Aggregate& matter) {
    double smallest = 1;
    for (const SmallCell& cell : cells_below(matter, 1.0)) {
        if (matter.cell_fill[cell.run->first + cell.n] < 0.25f) continue;
        smallest = std::min(smallest, cell.volume);
    }
    return smallest;
}

}  // namespace swage
