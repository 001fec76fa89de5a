// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/force_slabs.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

// Cells, or particles of springs, in a slab: the fewest take about as long as handing them over (20
// us). Each has a seam, so there are no more than keep a few threads busy unless all are
// as large as the next.
constexpr std::size_t kFewestCells = 1024, kFewSlabs = 8, kManyCells = 8192, kMostSlabs = 32;
// Particles of which all seams take that long to add.
constexpr std::size_t kSeamShare = 16384;
std::size_t slab_count(std::size_t cells) {
    const std::size_t few = std::min(cells / kFewestCells, kFewSlabs);
    return std::clamp<std::size_t>(cells / kManyCells, std::max<std::size_t>(1, few), kMostSlabs);
}

SWAGE_VECTOR_CLONES
void add_block(const double* __restrict f, std::size_t count, double* __restrict sum) {
    for (std::size_t n = 0; n < count; ++n) sum[n] += f[n];
}

void make_seam(RowSlab& slab) {
    const ParticleId seam = slab.reach - slab.end;
    slab.seam.resize(seam > 0 ? static_cast<std::size_t>(slab.room + seam + kSeamRoom) : 0);
}

// Adds a run in pieces of one material each.
void add_pieces(const Aggregate& matter, const CellRun& run, std::vector<CellRun>& pieces) {
    for (int n = 0; n < run.count; ++n) {
        const CellId cell = run.first + n;
        if (n == 0 || matter.cell_material[cell] != matter.cell_material[cell - 1]) {
            CellRun piece = run;
            piece.i += n, piece.first = cell, piece.count = 0, piece.row = run.row_at(n);
            pieces.push_back(piece);
        }
        ++pieces.back().count;
    }
}

}  // namespace

CellPieces::CellPieces(const Aggregate& matter, const std::vector<RowSlab>& slabs) {
    for (const RowSlab& slab : slabs) {
        first_.push_back(matter.inset.empty() ? slab.run_begin : piece_.size());
        for (std::size_t r = slab.run_begin; r < slab.run_end && !matter.inset.empty(); ++r) {
            add_pieces(matter, matter.lattice.cell_run[r], piece_);
        }
    }
    first_.push_back(all(matter).size());
}

std::vector<RowSlab> cell_slabs(const Aggregate& matter) {
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const auto same_row = [](const CellRun& a, const CellRun& b) {
        return a.j == b.j && a.k == b.k;
    };
    const auto row_begin = [&](const CellRun& run) {
        return row_of(matter.lattice.particle_run, run.j, run.k).front().first;
    };
    const std::size_t cells = matter.cell_fill.size();
    const std::size_t count = slab_count(cells);
    std::vector<RowSlab> slabs;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const bool full = !slabs.empty() && !same_row(runs[r], runs[r - 1]) &&
                          std::size_t(runs[r].first) >= cells * slabs.size() / count;
        if (slabs.empty() || full) slabs.push_back({r, r, 0, 0, 0, {}, kSeamRoom});
        slabs.back().run_end = r + 1;
    }
    for (std::size_t s = 0; s < slabs.size(); ++s) {
        RowSlab& slab = slabs[s];
        slab.begin = s == 0 ? 0 : slabs[s - 1].end;
        slab.end = s + 1 == slabs.size() ? static_cast<ParticleId>(matter.particle_count())
                                         : row_begin(runs[slab.run_end]);
        slab.reach = slab.end;
        for (std::size_t r = slab.run_begin; r < slab.run_end; ++r) {
            slab.reach = std::max(slab.reach, runs[r].row[3] + runs[r].count + 1);
        }
        make_seam(slab);
    }
    return slabs;
}

std::vector<SpringRun> spring_runs(const Lattice& lattice) {
    constexpr int kAbove[4][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
    std::vector<SpringRun> runs;
    for (const ParticleRun& own : lattice.particle_run) {
        std::array<std::span<const ParticleRun>, 4> row;
        for (int r = 0; r < 4; ++r) {
            row[r] = row_of(lattice.particle_run, own.j + kAbove[r][0], own.k + kAbove[r][1]);
        }
        // Cut where the row above changes from one run to another.
        std::array<const ParticleRun*, 4> now{};
        for (int i = own.i; i < own.i + own.count; ++i) {
            bool goes_on = i > own.i;
            std::array<const ParticleRun*, 4> here{};
            for (int r = 0; r < 4; ++r) {
                for (const ParticleRun& up : row[r]) {
                    if (i >= up.i && i < up.i + up.count) here[r] = &up;
                }
                goes_on = goes_on && (!here[r] || !now[r] || here[r] == now[r]);
            }
            if (!goes_on) {
                runs.push_back(
                    {own.j, own.k, own.first + (i - own.i), 0, {-1, -1, -1, -1}, {-1, -1, -1, -1}});
                now = {};
            }
            SpringRun& run = runs.back();
            for (int r = 0; r < 4; ++r) {
                if (!here[r] || now[r]) continue;
                now[r] = here[r];
                run.met[r] = here[r]->first + (i - here[r]->i);
                run.above[r] = run.met[r] - run.count;
            }
            ++run.count;
        }
    }
    return runs;
}

std::vector<RowSlab> spring_slabs(const std::vector<SpringRun>& runs, std::size_t particles) {
    const std::size_t count = slab_count(particles);
    std::vector<RowSlab> slabs;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const bool same_row = r > 0 && runs[r].j == runs[r - 1].j && runs[r].k == runs[r - 1].k;
        const bool full = !slabs.empty() && !same_row &&
                          std::size_t(runs[r].first) >= particles * slabs.size() / count;
        if (slabs.empty() || full) slabs.push_back({r, r, runs[r].first, 0, 0, {}, kSeamRoom});
        RowSlab& slab = slabs.back();
        slab.run_end = r + 1;
        slab.end = runs[r].first + runs[r].count;
        slab.reach = std::max(slab.reach, slab.end);
        for (const ParticleId above : runs[r].above) {
            if (above >= 0) slab.reach = std::max(slab.reach, above + runs[r].count + 1);
        }
    }
    const ParticleId last = static_cast<ParticleId>(particles);
    for (RowSlab& slab : slabs) {
        slab.reach = std::min(slab.reach, last);
        for (std::size_t r = slab.run_begin; r < slab.run_end; ++r) {
            for (int q = 0; q < 4; ++q) {
                if (runs[r].met[q] < slab.end) continue;
                slab.room = std::max(slab.room, slab.end - runs[r].above[q] + 1);
            }
        }
        make_seam(slab);
    }
    return slabs;
}

ForceRows force_rows(RowSlab& slab, Vec3Array& force) {
    ForceRows rows{{force.x.data(), force.y.data(), force.z.data()}};
    double** seam = rows.seam;
    for (std::vector<double>* component : {&slab.seam.x, &slab.seam.y, &slab.seam.z}) {
        std::fill(component->begin(), component->end(), 0.0);
        *seam++ = component->empty() ? nullptr : component->data() + slab.room;
    }
    return rows;
}

void add_seams(const std::vector<RowSlab>& slabs, Vec3Array& force) {
    if (slabs.size() <= 1) return;
    const std::size_t share = static_cast<std::size_t>(slabs.back().end) / kSeamShare;
    parallel_for(slabs.size() - 1, share, [&](std::size_t index) {
        const RowSlab& to = slabs[index + 1];
        for (std::size_t s = 0; s <= index; ++s) {
            const RowSlab& from = slabs[s];
            const ParticleId begin = std::max(to.begin, from.end);
            const ParticleId end = std::min(to.end, from.reach);
            if (begin >= end) continue;
            const std::size_t skip = begin - from.end + from.room, count = end - begin;
            add_block(from.seam.x.data() + skip, count, force.x.data() + begin);
            add_block(from.seam.y.data() + skip, count, force.y.data() + begin);
            add_block(from.seam.z.data() + skip, count, force.z.data() + begin);
        }
    });
}

}  // namespace swage
