// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/flowed_volume.h"

#include "base/parallel.h"
#include "base/portable_math.h"
#include "laws/yield.h"
#include "matter/broken_cells.h"
#include "matter/spring_layout.h"
#include "sim/cell_volume.h"
#include "sim/flowed_stretch.h"

namespace swage {

namespace {

constexpr std::size_t kRunsPerChunk = 64;

double flowed_share(const Aggregate& matter, const CellRun& run, int n) {
    const CellId cell = run.first + n;
    if (matter.mixed_at(cell) != nullptr || !cell_is_sound(matter, cell, run.row_at(n))) return 1;
    if (matter.material.mechanics != Mechanics::springs) {
        return 1 / flowed_stretch(matter, cell).determinant();
    }
    if (!(matter.hardening_of(cell) > 0)) return 1;
    const CellSprings<double> springs = springs_of(matter, cell, run.row_at(n));
    const SpringFrame<double> frame = frame_of(springs, kSpringLayout);
    const double pressed = frame.pressed(frame.sums(springs.strain));
    return cell_gradient(matter, run, n).determinant() * portable::exp(-3 * pressed);
}

}  // namespace

CellSprings<double> springs_of(const Aggregate& matter, CellId cell,
                               const std::array<ParticleId, 4>& row) {
    CellSprings<double> springs;
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        const CellConnection& c = kCellConnection[slot];
        const Vec3 way = (matter.particle_position.at(corner_particle(row, upper_corner(c))) -
                          matter.particle_position.at(corner_particle(row, c.corner))) /
                         reference_length(matter.lattice, c.direction);
        springs.way[slot] = {way.x(), way.y(), way.z()};
        const auto& plastic = matter.cell_plastic[slot];
        springs.strain[slot] =
            log_ratio(way.norm()) - (plastic.empty() ? 0.0 : double(plastic[cell]));
    }
    return springs;
}

double flowed_volume(const Aggregate& matter) {
    if (!matter.has_flowed()) return 1;
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const auto grown = [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t r = begin; r < end; ++r) {
            for (int n = 0; n < runs[r].count; ++n) {
                sum += matter.cell_fill[runs[r].first + n] * (flowed_share(matter, runs[r], n) - 1);
            }
        }
        return sum;
    };
    double sum = 0, whole = 0;
    for (double part : parallel_parts(runs.size(), kRunsPerChunk, grown)) sum += part;
    for (float fill : matter.cell_fill) whole += fill;
    return 1 + sum / whole;
}

}  // namespace swage
