// SPDX-License-Identifier: GPL-3.0-or-later
// The cubic lattice that a body's particles and cells lie on.
//
// The lattice is structured. Particles are numbered along x, then y, then z, with only the active
// ones present; a *row* is the active particles of one (y, z), in one or more *runs* of consecutive
// sites. Every particle owns nine forward connections, one for each of kForward; the array of
// direction d is indexed by the particle at the lower end. The other end is found by a constant
// offset along each *span*, so no index list is kept.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "base/math.h"
#include "matter/vec3_array.h"

namespace swage {

using ParticleId = std::int32_t;
using CellId = std::int32_t;

// Nine forward neighbours of a site: three edges, six face diagonals (18 neighbours in all).
inline constexpr int kForwardCount = 9;
inline constexpr int kEdgeCount = 3;
inline constexpr std::array<std::array<int, 3>, kForwardCount> kForward = {{
    {1, 0, 0},
    {0, 1, 0},
    {0, 0, 1},
    {1, 1, 0},
    {-1, 1, 0},
    {1, 0, 1},
    {-1, 0, 1},
    {0, 1, 1},
    {0, -1, 1},
}};

// The 24 connections that lie in a cell: direction, and the corner at the lower end.
inline constexpr int kCellConnectionCount = 24;
struct CellConnection {
    int direction, corner;
};
inline constexpr std::array<CellConnection, kCellConnectionCount> kCellConnection = [] {
    std::array<CellConnection, kCellConnectionCount> table{};
    int slot = 0;
    for (int d = 0; d < kForwardCount; ++d) {
        for (int corner = 0; corner < 8; ++corner) {
            bool inside = true;
            for (int axis = 0; axis < 3; ++axis) {
                const int at = (corner >> axis & 1) + kForward[d][axis];
                inside = inside && at >= 0 && at <= 1;
            }
            if (inside) table[slot++] = {d, corner};
        }
    }
    return table;
}();
// The corner at its other end.
constexpr int upper_corner(const CellConnection& c) {
    const auto& f = kForward[c.direction];
    return c.corner + f[0] + 2 * f[1] + 4 * f[2];
}

// A number for each site within a million cells of the origin.
inline std::uint64_t key_of(const Vec3i& site) {
    const auto part = [](int i) { return static_cast<std::uint64_t>(i + (1 << 20)) & 0x1FFFFF; };
    return part(site.x()) | part(site.y()) << 21 | part(site.z()) << 42;
}

// Consecutive particles along x.
struct ParticleRun {
    int i, j, k;  // lattice site of the first
    ParticleId first;
    int count;
};

// Connections of one direction between particles lower + n and upper + n, n = 0 ... count - 1.
struct Span {
    int direction;  // into kForward
    ParticleId lower;
    ParticleId upper;
    int count;
};

// The particle at corner c of the cell whose first particles in its four rows these are: bit 0 of c
// is along x, bit 1 along y, bit 2 along z.
inline ParticleId corner_particle(const std::array<ParticleId, 4>& row, int c) {
    return row[c >> 1] + (c & 1);
}

// Consecutive cells along x. Cell n has the particles row[0] + n and + n + 1 at (y, z), row[1] at
// (y + 1, z), row[2] at (y, z + 1), row[3] at (y + 1, z + 1).
struct CellRun {
    int i, j, k;  // lattice site of the first cell's low corner
    CellId first;
    int count;
    std::array<ParticleId, 4> row;

    // The first of cell n's two in each row.
    std::array<ParticleId, 4> row_at(int n) const {
        return {row[0] + n, row[1] + n, row[2] + n, row[3] + n};
    }
    // The particle at corner c of cell n.
    ParticleId corner(int n, int c) const { return corner_particle(row, c) + n; }
};

// Those of one (y, z), of runs in the order of a lattice's.
std::span<const ParticleRun> row_of(const std::vector<ParticleRun>& runs, int j, int k);

struct Lattice {
    Vec3 origin = Vec3::Zero();        // site (0, 0, 0) at molding [m]
    double spacing = 0;                // [m]
    Vec3i cell_count = Vec3i::Zero();  // cells of the box along x, y, z
    std::vector<ParticleRun> particle_run;
    std::vector<Span> span;  // in the order of their lower particle's run
    std::vector<CellRun> cell_run;
    std::vector<int>
        cell_row_begin;  // for (j, k) = j + cell_count.y() * k: first cell_run; one more at the end

    double cell_volume() const { return spacing * spacing * spacing; }
    // Those of one (y, z) within the box.
    std::span<const CellRun> cell_runs(int j, int k) const {
        const std::size_t row = j + static_cast<std::size_t>(cell_count.y()) * k;
        return {cell_run.data() + cell_row_begin[row], cell_run.data() + cell_row_begin[row + 1]};
    }
    // The cell at this site, or -1.
    CellId cell_at(int i, int j, int k) const;
    CellId cell_at(const Vec3i& site) const { return cell_at(site.x(), site.y(), site.z()); }
    // Calls visit(cell, its site) with the cells there are at and around a site, in the order of
    // neighbor_step.
    template <typename Visit>
    void for_each_cell_around(const Vec3i& site, const Visit& visit) const {
        for (int n = 0; n < 27; ++n) {
            const Vec3i at = site + neighbor_step(n);
            const CellId cell = cell_at(at);
            if (cell >= 0) visit(cell, at);
        }
    }
    Vec3i cell_site(CellId cell) const;
    // Corner c has bit 0 along x, bit 1 along y, bit 2 along z.
    std::array<ParticleId, 8> cell_corners(CellId cell) const;
    std::array<ParticleId, 4> cell_row(CellId cell) const;  // CellRun::row_at
    // Of each particle the cell whose lowest corner it is, or -1.
    std::vector<CellId> cells_by_low_corner() const;
};

// Where the particles were at molding: on the lattice's sites, so that none need be kept.
class ReferencePlaces {
  public:
    ReferencePlaces() = default;
    // `step`: from a site to the next along x, y, z [m].
    ReferencePlaces(const Vec3& origin, const Vec3& step, const Lattice& lattice);

    std::size_t size() const { return size_; }
    Vec3 at(std::size_t particle) const;
    // Of a place in a cell, by its lowest corner.
    Vec3 in_cell(std::size_t corner, const Vec3& place) const {
        const Vec3 low = at(corner);
        return {low.x() + step_.x() * place.x(), low.y() + step_.y() * place.y(),
                low.z() + step_.z() * place.z()};
    }
    Vec3Array all() const;

    template <typename Io>
    void visit(Io& io) {  // as SparseArray has it
        auto& [origin, step, size, run, first] = *this;
        io(origin, step, size, run, first);
    }

  private:
    Vec3 origin_ = Vec3::Zero(), step_ = Vec3::Zero();
    std::size_t size_ = 0;
    std::vector<ParticleRun> run_;
    std::vector<std::int32_t> first_;  // run of every kStride-th particle
};

inline double reference_length(const Lattice& lattice, int direction) {
    return lattice.spacing * (direction < kEdgeCount ? 1.0 : std::numbers::sqrt2);
}

// Derives runs, spans and corners from the set of active cells (a site each, sorted by z, y, x;
// no duplicates). Particle and cell arrays are not touched.
Lattice make_lattice(const Vec3& origin, double spacing, const Vec3i& cell_count,
                     const std::vector<Vec3i>& active_cells);

}  // namespace swage
