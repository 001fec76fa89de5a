// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/force_slabs.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kSlabCells = 8192, kMostSlabs = 32;

SWAGE_VECTOR_CLONES
void add_block(const double* __restrict f, std::size_t count, double* __restrict sum) {
    for (std::size_t n = 0; n < count; ++n) sum[n] += f[n];
}

}  // namespace

void ForceSlab::clear() {
    for (auto* component : {&part.x, &part.y, &part.z}) {
        std::fill(component->begin(), component->end(), 0.0);
    }
}

void sum_slabs(const ForceSlabs& slabs, std::size_t particles, Vec3Array& force) {
    force.resize(particles);
    const std::size_t chunks = std::max<std::size_t>(1, slabs.size());
    parallel_for(chunks, [&](std::size_t chunk) {
        const std::size_t begin = particles * chunk / chunks;
        const std::size_t end = particles * (chunk + 1) / chunks;
        std::fill(force.x.begin() + begin, force.x.begin() + end, 0.0);
        std::fill(force.y.begin() + begin, force.y.begin() + end, 0.0);
        std::fill(force.z.begin() + begin, force.z.begin() + end, 0.0);
        for (const ForceSlab& slab : slabs) {
            const std::size_t from = std::max<std::size_t>(begin, slab.begin);
            const std::size_t to = std::min<std::size_t>(end, slab.reach);
            if (from >= to) continue;
            add_block(slab.part.x.data() + (from - slab.begin), to - from, force.x.data() + from);
            add_block(slab.part.y.data() + (from - slab.begin), to - from, force.y.data() + from);
            add_block(slab.part.z.data() + (from - slab.begin), to - from, force.z.data() + from);
        }
    });
}

std::vector<SpanSlab> span_slabs(const Aggregate& matter, ForceSlabs& part) {
    constexpr std::size_t kSlabParticles = 8192, kMost = 64;
    const std::vector<Span>& spans = matter.lattice.span;
    const std::size_t particles = matter.particle_count();
    const std::size_t slabs = std::clamp<std::size_t>(particles / kSlabParticles, 1, kMost);
    std::vector<SpanSlab> slab;
    part.clear();
    std::size_t s = 0;
    for (std::size_t n = 0; n < slabs; ++n) {
        const std::size_t begin = s, stop = particles * (n + 1) / slabs;
        ForceSlab force;
        force.begin = s < spans.size() ? spans[s].lower : static_cast<ParticleId>(particles);
        force.reach = force.begin;
        while (s < spans.size() &&
               (n + 1 == slabs || static_cast<std::size_t>(spans[s].lower) < stop)) {
            force.begin = std::min(force.begin, spans[s].lower);
            force.reach = std::max(force.reach, spans[s].upper + spans[s].count);
            ++s;
        }
        if (s == begin) continue;
        force.part.resize(static_cast<std::size_t>(force.reach - force.begin));
        slab.push_back({begin, s});
        part.push_back(std::move(force));
    }
    return slab;
}

std::vector<CellSlab> cell_slabs(const Aggregate& matter) {
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const auto same_row = [](const CellRun& a, const CellRun& b) {
        return a.j == b.j && a.k == b.k;
    };
    // The first particle at (j, k).
    const auto row_begin = [&](const CellRun& run) {
        const auto& rows = matter.lattice.particle_run;
        return std::lower_bound(rows.begin(), rows.end(), std::pair(run.k, run.j),
                                [](const ParticleRun& row, const std::pair<int, int>& at) {
                                    return std::pair(row.k, row.j) < at;
                                })
            ->first;
    };
    const std::size_t cells = matter.cell_fill.size();
    const std::size_t count = std::clamp<std::size_t>(cells / kSlabCells, 1, kMostSlabs);
    std::vector<CellSlab> slabs;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const bool full = !slabs.empty() && !same_row(runs[r], runs[r - 1]) &&
                          std::size_t(runs[r].first) >= cells * slabs.size() / count;
        if (slabs.empty() || full) slabs.push_back({r, r, 0, 0, 0, {}});
        slabs.back().run_end = r + 1;
    }
    for (std::size_t s = 0; s < slabs.size(); ++s) {
        CellSlab& slab = slabs[s];
        slab.begin = s == 0 ? 0 : slabs[s - 1].end;
        slab.end = s + 1 == slabs.size() ? static_cast<ParticleId>(matter.particle_count())
                                         : row_begin(runs[slab.run_end]);
        slab.reach = slab.end;
        for (std::size_t r = slab.run_begin; r < slab.run_end; ++r) {
            slab.reach = std::max(slab.reach, runs[r].row[3] + runs[r].count + 1);
        }
        const ParticleId seam = slab.reach - slab.end;
        slab.seam.resize(seam > 0 ? static_cast<std::size_t>(seam + kSeamRoom) : 0);
    }
    return slabs;
}

void add_seams(const std::vector<CellSlab>& slabs, Vec3Array& force) {
    if (slabs.size() <= 1) return;
    parallel_for(slabs.size() - 1, [&](std::size_t index) {
        const CellSlab& to = slabs[index + 1];
        for (std::size_t s = 0; s <= index; ++s) {
            const CellSlab& from = slabs[s];
            const ParticleId begin = std::max(to.begin, from.end);
            const ParticleId end = std::min(to.end, from.reach);
            if (begin >= end) continue;
            const std::size_t skip = begin - from.end, count = end - begin;
            add_block(from.seam.x.data() + skip, count, force.x.data() + begin);
            add_block(from.seam.y.data() + skip, count, force.y.data() + begin);
            add_block(from.seam.z.data() + skip, count, force.z.data() + begin);
        }
    });
}

}  // namespace swage
