// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_volume.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/cell_batch.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kRunsPerChunk = 64;
constexpr std::size_t kCellsPerChunk = 4096;  // about; fewer take less than handing over

// 64 a^3 times the volume ratios of a batch of cells, at their middles.
template <typename V>
SWAGE_INLINE V batch_volumes(const CornerRows& rows, int begin, int count) {
    const CornerSums<V> c = gather<V>(rows, begin, count);
    return dot(c.x, cross(c.y, c.z));
}

struct VolumeTask {
    CornerRows rows;
    int count;
    double scale;
    double* volume;  // in whole vectors
};
template <int kWidth>
SWAGE_INLINE void find_volumes(const VolumeTask& task) {
    typedef LanesOf<kWidth> V;
    for (int begin = 0; begin < task.count; begin += kWidth) {
        const int count = std::min(kWidth, task.count - begin);
        const V volume = task.scale * batch_volumes<V>(task.rows, begin, count);
        store(volume, task.volume + begin);
    }
}

// Runs with any cell below a volume, at the cells' middles.
struct SmallRunsTask {
    const Aggregate& matter;
    const CellRun *run, *run_end;
    double limit;  // times 64 a^3
    std::vector<const CellRun*>& found;
};
template <int kWidth>
SWAGE_INLINE void find_small_runs(const SmallRunsTask& task) {
    typedef LanesOf<kWidth> V;
    typename LaneBatch<kWidth>::Indices lane;
    for (int l = 0; l < kWidth; ++l) lane[l] = l;
    for (const CellRun* run = task.run; run != task.run_end; ++run) {
        const CornerRows rows = corner_rows(task.matter.particle_position, *run);
        const V enough = V{} + task.limit;
        V smallest = enough;
        for (int begin = 0; begin < run->count; begin += kWidth) {
            const int count = std::min(kWidth, run->count - begin);
            const V volume = batch_volumes<V>(rows, begin, count);
            smallest = lane < count && volume < smallest ? volume : smallest;
        }
        bool small = false;
        for (int l = 0; l < kWidth; ++l) small = small || smallest[l] < task.limit;
        if (small) task.found.push_back(run);
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
            if (!cell_is_sound(matter, run.first + at + n, run.row_at(at + n))) continue;
            found.push_back({&run, at + n, volume[n]});
        }
    }
}

std::vector<SmallCell> cells_below(const Aggregate& matter, double limit) {
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const bool springs = matter.material.mechanics == Mechanics::springs;
    const double spacing = matter.lattice.spacing, full = 64 * spacing * spacing * spacing;
    const std::size_t chunks = matter.cell_fill.size() / kCellsPerChunk + 1;
    std::vector<std::vector<SmallCell>> part(chunks);
    parallel_for(chunks, [&](std::size_t chunk) {
        const CellRun* const begin = runs.data() + runs.size() * chunk / chunks;
        const CellRun* const end = runs.data() + runs.size() * (chunk + 1) / chunks;
        if (!springs) {  // not all cells are looked at from their middles
            for (const CellRun* run = begin; run != end; ++run) {
                add_cells_below(matter, *run, limit, part[chunk]);
            }
            return;
        }
        std::vector<const CellRun*> small;
        const SmallRunsTask task{matter, begin, end, limit * full * (1 + 1e-12), small};
        by_width([&]<int kWidth>()
                     __attribute__((always_inline)) { find_small_runs<kWidth>(task); });
        for (const CellRun* run : small) add_cells_below(matter, *run, limit, part[chunk]);
    });
    std::vector<SmallCell> found;
    for (const auto& p : part) found.insert(found.end(), p.begin(), p.end());
    return found;
}

void cell_volumes(const Aggregate& matter, const CellRun& run, int at, int count, double* volume) {
    const double spacing = matter.lattice.spacing;
    const VolumeTask task{corner_rows(matter.particle_position, run, at), count,
                          1 / (64 * spacing * spacing * spacing), volume};
    by_width([&]<int kWidth>() __attribute__((always_inline)) { find_volumes<kWidth>(task); });
}

Mat3 cell_gradient(const Aggregate& matter, const CellRun& run, int n) {
    Mat3 gradient = Mat3::Zero();
    for (int c = 0; c < 8; ++c) {
        const Vec3 x = matter.particle_position.at(run.corner(n, c));
        for (int axis = 0; axis < 3; ++axis) {
            gradient.col(axis) += (c >> axis & 1 ? 0.25 : -0.25) / matter.lattice.spacing * x;
        }
    }
    return gradient;
}

CornerSums<double> corner_sums(const Aggregate& matter, const CellRun& run, int n) {
    const Vec3Array& x = matter.particle_position;
    double at[3][8];
    for (int c = 0; c < 8; ++c) {
        const ParticleId p = run.corner(n, c);
        at[0][c] = x.x[p], at[1][c] = x.y[p], at[2][c] = x.z[p];
    }
    return sum_corners(at);
}

Triple<double> material_place(const Aggregate& matter, CellId cell) {
    if (is_centred(matter, cell)) return {0, 0, 0};
    const Vec3 at = 2 * matter.cell_centroid[cell].cast<double>();
    return {at.x(), at.y(), at.z()};
}

CellHistory<double> committed_history(const Aggregate& matter, CellId cell) {
    CellHistory<double> history{};
    if (matter.cell_history.empty()) return history;
    for_each_number(history, [&](int n, double& to) { to = matter.cell_history.row[n][cell]; });
    return history;
}

BackStrain<double> committed_back(const Aggregate& matter, CellId cell) {
    BackStrain<double> back{};
    if (matter.cell_back.empty()) return back;
    for_each_number(back.strain, back.modes,
                    [&](int n, double& to) { to = matter.cell_back.row[n][cell]; });
    return back;
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

std::size_t cracked_inside_out(const Aggregate& matter) {
    if (matter.cell_cracked.empty()) return 0;
    std::size_t found = 0;
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            found += matter.cell_cracked[run.first + n] != 0 &&
                     cell_is_whole(matter, run.row_at(n)) &&
                     cell_gradient(matter, run, n).determinant() < 0;
        }
    }
    return found;
}

double present_volume(const Aggregate& matter) {
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const double a = matter.lattice.spacing;
    const auto sum = [&](std::size_t begin, std::size_t end) {
        double whole = 0;
        for (std::size_t r = begin; r < end; ++r) {
            for (int n = 0; n < runs[r].count; ++n) {
                const CellId cell = runs[r].first + n;
                const bool sound = cell_is_sound(matter, cell, runs[r].row_at(n));
                whole += matter.cell_fill[cell] *
                         (sound ? material_gradient(matter, runs[r], n).determinant() : 1.0);
            }
        }
        return whole;
    };
    double whole = 0;
    for (double part : parallel_parts(runs.size(), kRunsPerChunk, sum)) whole += part;
    return a * a * a * whole;
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
