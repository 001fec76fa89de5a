// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/loose_particles.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "skin/carrier.h"

namespace swage {

namespace {

constexpr double kAway = 0.15;  // spacings that a loose particle may be from its place
constexpr std::size_t kChunk = 128;

struct SliverCorner {
    ParticleId particle;
    CellId cell;
    int corner;
};

bool is_firm(const Aggregate& matter, CellId cell) { return matter.cell_fill[cell] >= kFirmFill; }

// Each particle that no firm cell holds, with each cell that does, in their order.
std::vector<SliverCorner> sliver_corners(const Aggregate& matter) {
    std::vector<char> held(matter.particle_count(), 0);
    std::vector<SliverCorner> sliver;
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const bool firm = is_firm(matter, run.first + n);
            for (int c = 0; c < 8; ++c) {
                const ParticleId p = run.corner(n, c);
                if (firm) held[p] = 1;
                if (!firm) sliver.push_back({p, run.first + n, c});
            }
        }
    }
    std::erase_if(sliver, [&](const SliverCorner& s) { return held[s.particle]; });
    std::sort(sliver.begin(), sliver.end(), [](const SliverCorner& a, const SliverCorner& b) {
        return std::pair(a.particle, a.cell) < std::pair(b.particle, b.cell);
    });
    return sliver;
}

// A bit for each of the 27 cells around this one that is firm.
std::uint32_t firm_around(const Aggregate& matter, CellId cell) {
    const Vec3i site = matter.lattice.cell_site(cell);
    std::uint32_t firm = 0;
    for (int n = 0; n < 27; ++n) {
        const CellId next = matter.lattice.cell_at(site + neighbor_step(n));
        if (next >= 0 && is_firm(matter, next)) firm |= 1u << n;
    }
    return firm;
}

// The firm cells nearest to a particle among those around its slivers; nothing where there is none
// around one of these.
std::vector<CellId> nearest_firm(const Aggregate& matter, std::span<const SliverCorner> slivers,
                                 const std::vector<std::uint32_t>& around) {
    std::vector<CellId> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const SliverCorner& sliver : slivers) {
        const std::uint32_t firm = around[sliver.cell];
        if (firm == 0) return {};
        const Vec3 own = corner_step(sliver.corner).cast<double>();
        for (int n = 0; n < 27; ++n) {
            if (!(firm >> n & 1)) continue;
            const Vec3i step = neighbor_step(n);
            const double d = (own - step.cast<double>() - Vec3::Constant(0.5)).squaredNorm();
            if (d > least) continue;
            if (d < least) nearest.clear(), least = d;
            nearest.push_back(matter.lattice.cell_at(matter.lattice.cell_site(sliver.cell) + step));
        }
    }
    std::sort(nearest.begin(), nearest.end());
    nearest.erase(std::unique(nearest.begin(), nearest.end()), nearest.end());
    return nearest;
}

// What these cells, each strained as in its mean, make of a place: adds to `share`.
void add_shares(const Aggregate& matter, const std::vector<CellId>& cells, const Vec3& place,
                std::vector<LooseParticles::Share>& share) {
    const std::size_t first = share.size();
    for (CellId cell : cells) {
        const auto corner = matter.lattice.cell_corners(cell);
        const Vec3 low = matter.particle_reference.at(corner[0]);
        const Vec3 size = matter.particle_reference.at(corner[7]) - low;
        const Vec3 from_center = (place - low).cwiseQuotient(size) - Vec3::Constant(0.5);
        for (int c = 0; c < 8; ++c) {
            double w = 0.125;  // and the mean of the four edges' slopes along each axis
            for (int d = 0; d < 3; ++d) w += 0.25 * (c >> d & 1 ? 1 : -1) * from_center[d];
            w /= static_cast<double>(cells.size());
            const auto same = std::find_if(share.begin() + first, share.end(),
                                           [&](const auto& s) { return s.particle == corner[c]; });
            if (same == share.end()) {
                share.push_back({corner[c], w});
            } else {
                same->weight += w;
            }
        }
    }
}

bool all_edges_hold(const Aggregate& matter, CellId cell) {
    const auto corner = matter.lattice.cell_corners(cell);
    for (const CellConnection& link : kCellConnection) {
        if (link.direction >= kEdgeCount) break;
        if (matter.connection[link.direction].weight[corner[link.corner]] <= 0) return false;
    }
    return true;
}

// The cells' own corner that the particle is.
int corner_of(const Aggregate& matter, CellId cell, ParticleId particle) {
    const auto corner = matter.lattice.cell_corners(cell);
    return static_cast<int>(std::find(corner.begin(), corner.end(), particle) - corner.begin());
}

// The nearest whole firm cells that share a corner with what hangs together with the particle in
// one of its slivers.
std::vector<CellId> firm_left(const Aggregate& matter, ParticleId particle,
                              std::span<const CellId> slivers) {
    std::vector<CellId> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (CellId sliver : slivers) {
        const int own = corner_of(matter, sliver, particle);
        const CornerMask held = corner_groups(matter, matter.lattice.cell_corners(sliver))[own];
        const Vec3i site = matter.lattice.cell_site(sliver);
        const Vec3 at = corner_step(own).cast<double>();
        for (int n = 0; n < 27; ++n) {
            const Vec3i step = neighbor_step(n), next = site + step;
            bool shares = false;
            for (int c = 0; c < 8 && !shares; ++c) {
                const Vec3i in_next = corner_step(c) - step;
                shares = (held >> c & 1) && in_next.minCoeff() >= 0 && in_next.maxCoeff() <= 1;
            }
            const double d = (at - step.cast<double>() - Vec3::Constant(0.5)).squaredNorm();
            if (!shares || d > least) continue;
            const CellId cell = matter.lattice.cell_at(next);
            if (cell < 0 || !is_firm(matter, cell) || !all_edges_hold(matter, cell)) continue;
            if (d < least) nearest.clear(), least = d;
            nearest.push_back(cell);
        }
    }
    std::sort(nearest.begin(), nearest.end());
    nearest.erase(std::unique(nearest.begin(), nearest.end()), nearest.end());
    return nearest;
}

}  // namespace

LooseParticles find_loose(const Aggregate& matter) {
    LooseParticles loose;
    const std::vector<SliverCorner> slivers = sliver_corners(matter);
    if (slivers.empty()) return loose;
    std::vector<std::uint32_t> around(matter.cell_fill.size(), 0);
    std::vector<CellId> cells;
    for (const SliverCorner& sliver : slivers) cells.push_back(sliver.cell);
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    parallel_each(cells.size(), kChunk,
                  [&](std::size_t n) { around[cells[n]] = firm_around(matter, cells[n]); });
    for (std::size_t begin = 0, end = 0; begin < slivers.size(); begin = end) {
        const ParticleId particle = slivers[begin].particle;
        while (end < slivers.size() && slivers[end].particle == particle) ++end;
        const auto own = std::span(slivers).subspan(begin, end - begin);
        const std::vector<CellId> firm = nearest_firm(matter, own, around);
        if (firm.empty()) continue;
        loose.particle.push_back(particle);
        loose.first_share.push_back(static_cast<int>(loose.share.size()));
        add_shares(matter, firm, matter.particle_reference.at(particle), loose.share);
        loose.first_need.push_back(static_cast<int>(loose.need.size()));
        for (const SliverCorner& sliver : own) loose.need.push_back(sliver.cell);
        loose.sliver_count.push_back(static_cast<int>(own.size()));
        loose.need.insert(loose.need.end(), firm.begin(), firm.end());
    }
    if (loose.particle.empty()) return loose;
    loose.first_share.push_back(static_cast<int>(loose.share.size()));
    loose.first_need.push_back(static_cast<int>(loose.need.size()));
    loose.slot.assign(matter.particle_count(), -1);
    for (std::size_t n = 0; n < loose.particle.size(); ++n) {
        loose.slot[loose.particle[n]] = static_cast<int>(n);
    }
    return loose;
}

std::vector<Vec3> loose_displacements(const LooseParticles& loose, const Aggregate& matter,
                                      const Vec3Array& reference) {
    const double most = kAway * matter.lattice.spacing;
    const auto displacement = [&](ParticleId p) -> Vec3 {
        return matter.particle_position.at(p) - reference.at(p);
    };
    const auto sum = [&](std::span<const LooseParticles::Share> shares) {
        Vec3 place = Vec3::Zero();
        for (const auto& [particle, weight] : shares) place += weight * displacement(particle);
        return place;
    };
    const auto part = [](const auto& all, const std::vector<int>& first, std::size_t n) {
        return std::span(all).subspan(first[n], first[n + 1] - first[n]);
    };
    std::vector<Vec3> moved(loose.particle.size());
    parallel_each(moved.size(), kChunk, [&](std::size_t n) {
        const ParticleId own = loose.particle[n];
        moved[n] = displacement(own);
        Vec3 should = sum(part(loose.share, loose.first_share, n));
        if ((moved[n] - should).squaredNorm() <= most * most) return;
        const std::span<const CellId> need = part(loose.need, loose.first_need, n);
        const bool hangs = std::all_of(need.begin(), need.end(),
                                       [&](CellId cell) { return all_edges_hold(matter, cell); });
        if (!hangs) {
            const std::vector<CellId> firm =
                firm_left(matter, own, need.first(loose.sliver_count[n]));
            if (firm.empty()) return;
            std::vector<LooseParticles::Share> share;
            add_shares(matter, firm, reference.at(own), share);
            should = sum(share);
        }
        const Vec3 away = moved[n] - should;
        if (away.squaredNorm() > most * most) moved[n] = should + most / away.norm() * away;
    });
    return moved;
}

}  // namespace swage
