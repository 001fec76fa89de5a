// SPDX-License-Identifier: GPL-3.0-or-later
// From a set of active cells to the structured lattice: particle runs, connection spans, cell runs.
#include <algorithm>
#include <map>

#include "matter/lattice.h"

namespace swage {

std::span<const ParticleRun> row_of(const std::vector<ParticleRun>& runs, int j, int k) {
    const auto place = [](const ParticleRun& run) { return std::pair(run.k, run.j); };
    return std::ranges::equal_range(runs, std::pair(k, j), {}, place);
}

namespace {

// Sites of the particles: all corners of active cells, in the order (k, j, i).
std::vector<ParticleRun> make_particle_runs(const std::vector<Vec3i>& cells) {
    // Row (j, k) of particles holds the corners of the cells of four rows.
    std::map<std::pair<int, int>, std::vector<int>> row_sites;  // (k, j) -> sites i, unsorted
    for (const Vec3i& cell : cells) {
        for (int dk = 0; dk < 2; ++dk) {
            for (int dj = 0; dj < 2; ++dj) {
                auto& sites = row_sites[{cell.z() + dk, cell.y() + dj}];
                sites.push_back(cell.x());
                sites.push_back(cell.x() + 1);
            }
        }
    }
    std::vector<ParticleRun> runs;
    ParticleId next = 0;
    for (auto& [row, sites] : row_sites) {
        std::sort(sites.begin(), sites.end());
        sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
        for (std::size_t n = 0; n < sites.size(); ++n) {
            if (n == 0 || sites[n] != sites[n - 1] + 1) {
                runs.push_back({sites[n], row.second, row.first, next, 0});
            }
            ++runs.back().count;
            ++next;
        }
    }
    return runs;
}

// Every pair of neighbouring sites that are both present, cut into spans of constant offset.
std::vector<Span> make_spans(const std::vector<ParticleRun>& runs) {
    std::vector<Span> spans;
    for (const ParticleRun& low : runs) {
        for (int d = 0; d < kForwardCount; ++d) {
            const auto [di, dj, dk] = kForward[d];
            if (dj == 0 && dk == 0) {
                if (low.count > 1) spans.push_back({d, low.first, low.first + 1, low.count - 1});
                continue;
            }
            for (const ParticleRun& up : row_of(runs, low.j + dj, low.k + dk)) {
                // Sites i of `low` whose neighbour i + di lies in `up`.
                const int begin = std::max(low.i, up.i - di);
                const int stop = std::min(low.i + low.count, up.i + up.count - di);
                if (begin >= stop) continue;
                spans.push_back(
                    {d, low.first + (begin - low.i), up.first + (begin + di - up.i), stop - begin});
            }
        }
    }
    return spans;
}

ParticleId particle_at(const std::vector<ParticleRun>& runs, int i, int j, int k) {
    for (const ParticleRun& run : row_of(runs, j, k)) {
        if (i >= run.i && i < run.i + run.count) return run.first + (i - run.i);
    }
    return -1;
}

std::vector<CellRun> make_cell_runs(const std::vector<Vec3i>& cells,
                                    const std::vector<ParticleRun>& particle_runs) {
    std::vector<CellRun> runs;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const Vec3i& at = cells[c];
        const bool goes_on = c > 0 && cells[c - 1] + Vec3i(1, 0, 0) == at;
        if (!goes_on) {
            CellRun run{at.x(), at.y(), at.z(), static_cast<CellId>(c), 0, {}};
            for (int row = 0; row < 4; ++row) {
                run.row[row] =
                    particle_at(particle_runs, at.x(), at.y() + (row & 1), at.z() + (row >> 1));
            }
            runs.push_back(run);
        }
        ++runs.back().count;
    }
    return runs;
}

}  // namespace

Lattice make_lattice(const Vec3& origin, double spacing, const Vec3i& cell_count,
                     const std::vector<Vec3i>& active_cells) {
    Lattice lattice;
    lattice.origin = origin;
    lattice.spacing = spacing;
    lattice.cell_count = cell_count;
    lattice.particle_run = make_particle_runs(active_cells);
    lattice.span = make_spans(lattice.particle_run);
    lattice.cell_run = make_cell_runs(active_cells, lattice.particle_run);

    const std::size_t rows = static_cast<std::size_t>(cell_count.y()) * cell_count.z();
    lattice.cell_row_begin.assign(rows + 1, 0);
    for (const CellRun& run : lattice.cell_run) {
        ++lattice.cell_row_begin[run.j + static_cast<std::size_t>(cell_count.y()) * run.k + 1];
    }
    for (std::size_t row = 0; row < rows; ++row) {
        lattice.cell_row_begin[row + 1] += lattice.cell_row_begin[row];
    }
    return lattice;
}

namespace {

constexpr std::size_t kStride = 64;  // particles

}  // namespace

ReferencePlaces::ReferencePlaces(const Vec3& origin, const Vec3& step, const Lattice& lattice)
    : origin_(origin), step_(step), run_(lattice.particle_run) {
    for (std::size_t r = 0; r < run_.size(); ++r) {
        size_ += static_cast<std::size_t>(run_[r].count);
        while (first_.size() * kStride < size_) first_.push_back(static_cast<std::int32_t>(r));
    }
}

Vec3 ReferencePlaces::at(std::size_t particle) const {
    const ParticleRun* run = &run_[first_[particle / kStride]];
    const int p = static_cast<int>(particle);
    while (p >= run->first + run->count) ++run;
    return origin_ + step_.cwiseProduct(Vec3(run->i + (p - run->first), run->j, run->k));
}

Vec3Array ReferencePlaces::all() const {
    Vec3Array places;
    places.resize(size_);
    for (std::size_t p = 0; p < size_; ++p) places.set(p, at(p));
    return places;
}

CellId Lattice::cell_at(int i, int j, int k) const {
    if (i < 0 || j < 0 || k < 0 || i >= cell_count.x() || j >= cell_count.y() ||
        k >= cell_count.z()) {
        return -1;
    }
    for (const CellRun& run : cell_runs(j, k)) {
        if (i >= run.i && i < run.i + run.count) return run.first + (i - run.i);
    }
    return -1;
}

namespace {
const CellRun& run_of_cell(const std::vector<CellRun>& runs, CellId cell) {
    const auto after =
        std::upper_bound(runs.begin(), runs.end(), cell,
                         [](CellId wanted, const CellRun& run) { return wanted < run.first; });
    return *std::prev(after);
}
}  // namespace

Vec3i Lattice::cell_site(CellId cell) const {
    const CellRun& run = run_of_cell(cell_run, cell);
    return {run.i + (cell - run.first), run.j, run.k};
}

std::array<ParticleId, 4> Lattice::cell_row(CellId cell) const {
    const CellRun& run = run_of_cell(cell_run, cell);
    return run.row_at(cell - run.first);
}

std::vector<CellId> Lattice::cells_by_low_corner() const {
    std::vector<CellId> cells;
    if (particle_run.empty()) return cells;
    cells.assign(std::size_t(particle_run.back().first + particle_run.back().count), -1);
    for (const CellRun& run : cell_run) {
        for (int n = 0; n < run.count; ++n) cells[run.row[0] + n] = run.first + n;
    }
    return cells;
}

std::array<ParticleId, 8> Lattice::cell_corners(CellId cell) const {
    const std::array<ParticleId, 4> row = cell_row(cell);
    std::array<ParticleId, 8> corner;
    for (int c = 0; c < 8; ++c) corner[c] = corner_particle(row, c);
    return corner;
}

}  // namespace swage
