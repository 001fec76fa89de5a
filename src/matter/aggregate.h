// SPDX-License-Identifier: GPL-3.0-or-later
// A body of matter: particles on a cubic lattice and the connections between neighbours, as arrays
// by component. No law is called here.
//
// The lattice is structured. Particles are numbered along x, then y, then z, with only the active
// ones present; a *row* is the active particles of one (y, z), in one or more *runs* of consecutive
// sites. Every particle owns nine forward connections, one for each of kForward; the array of
// direction d is indexed by the particle at the lower end. The other end is found by a constant
// offset along each *span*, so no index list is kept.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/math.h"
#include "base/sparse_array.h"
#include "geometry/box.h"
#include "matter/material.h"

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

struct Vec3Array {
    std::vector<double> x, y, z;

    std::size_t size() const { return x.size(); }
    void resize(std::size_t count) { x.resize(count), y.resize(count), z.resize(count); }
    Vec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::size_t i, const Vec3& v) { x[i] = v[0], y[i] = v[1], z[i] = v[2]; }
    void add(std::size_t i, const Vec3& v) { x[i] += v[0], y[i] += v[1], z[i] += v[2]; }
};

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

// Consecutive cells along x. Cell n has the particles row[0] + n and + n + 1 at (y, z), row[1] at
// (y + 1, z), row[2] at (y, z + 1), row[3] at (y + 1, z + 1).
struct CellRun {
    int i, j, k;  // lattice site of the first cell's low corner
    CellId first;
    int count;
    std::array<ParticleId, 4> row;
};

struct Lattice {
    Vec3 origin = Vec3::Zero();        // site (0, 0, 0) at molding [m]
    double spacing = 0;                // [m]
    Vec3i cell_count = Vec3i::Zero();  // cells of the box along x, y, z
    std::vector<ParticleRun> particle_run;
    std::vector<Span> span;  // in the order of their lower particle's run
    std::vector<CellRun> cell_run;
    std::vector<int>
        cell_row_begin;  // for (j, k) = j + cell_count.y() * k: first cell_run; one more at the end

    // The cell at this site, or -1.
    CellId cell_at(int i, int j, int k) const;
    Vec3i cell_site(CellId cell) const;
    // Corner c has bit 0 along x, bit 1 along y, bit 2 along z.
    std::array<ParticleId, 8> cell_corners(CellId cell) const;
};

// Where the particles were at molding: on the lattice's sites, so that none need be kept.
class ReferencePlaces {
  public:
    ReferencePlaces() = default;
    // `step`: from a site to the next along x, y, z [m].
    ReferencePlaces(const Vec3& origin, const Vec3& step, const Lattice& lattice);

    std::size_t size() const { return size_; }
    Vec3 at(std::size_t particle) const;
    Vec3Array all() const;

  private:
    Vec3 origin_ = Vec3::Zero(), step_ = Vec3::Zero();
    std::size_t size_ = 0;
    std::vector<ParticleRun> run_;
    std::vector<std::int32_t> first_;  // run of every kStride-th particle
};

// History and strength of the connections of one direction, indexed by the lower particle.
struct ConnectionArrays {
    double plastic_of(ParticleId lower) const { return plastic.empty() ? 0.0 : plastic[lower]; }

    SparseArray<float> weight;  // share of the full connection's section, 0: none (or no longer)
    // rest_length / reference_length - 1. Empty until springs flow: none has.
    std::vector<float> plastic;
    // Share of its stiffness that is lost for being pulled (laws/fracture.h); 1: broken by load,
    // its weight is then 0 too. Empty while nothing is damaged.
    std::vector<float> damage;
};

// A point of the body's true surface, carried by a cell: x = sum N_c x_c. What touches and is
// gripped is these, never particles.
struct SurfacePoints {
    std::vector<std::array<ParticleId, 8>> corner;
    std::vector<std::array<float, 8>> weight;  // sum to one; linear precision
    std::vector<double> area;                  // [m2], of the surface it stands for
    std::vector<Vec3> reference_position;      // at molding [m]
    std::vector<Vec3> reference_normal;        // unit, outward, at molding
    std::size_t size() const { return area.size(); }
};

// A cell through which the boundary of two materials runs.
struct MixedCell {
    static constexpr int kHistory = 19;  // as of a cell: stretch, modes, hardening
    CellId cell;
    std::array<std::uint8_t, 2> material;                 // as cell_material
    std::array<float, 2> fill;                            // shares of the cell's volume
    std::array<Eigen::Vector3f, 2> centroid;              // of these, in the cell, each -0.5 to 0.5
    Eigen::Vector3f normal;                               // of the boundary between them, unit
    std::array<std::array<float, kHistory>, 2> flowed{};  // committed
};

// What the connections of a cell are at rest with, beside what has flowed: l' = (1 + strain) l.
struct CellSet {
    CellId cell;
    std::array<float, kCellConnectionCount> strain;
};

struct Aggregate {
    Material material;  // its mechanics, friction and damping are the whole body's
    Lattice lattice;

    ReferencePlaces particle_reference;  // position at molding [m]
    Vec3Array particle_position;         // [m]
    Vec3Array particle_velocity;         // [m/s]
    std::vector<double> particle_mass;   // [kg]

    std::array<ConnectionArrays, kForwardCount> connection;

    std::vector<float> cell_fill;  // share of the cell's volume inside the mesh, > 0; slivers of a
                                   // neighbour can bring it slightly above 1
    SparseArray<Eigen::Vector3f> cell_centroid;  // of that share, in the cell, each -0.5 to 0.5

    // Of a body of several materials: the others; for each cell which it is, 0 being `material` and
    // m inset[m - 1]; and the cells, in their order, that hold two, whose cell_material is the one
    // with more of it. All empty where there is one material.
    std::vector<Material> inset;
    std::vector<std::uint8_t> cell_material;
    std::vector<MixedCell> mixed_cell;
    std::vector<char> cell_cracked;  // 1: has reached its strength; empty while none has
    // Of cells that have turned into springs: strain that is at rest, by slot; in the cells' order.
    std::vector<CellSet> cell_set;

    // History of the cells, committed; all empty while nothing has ever yielded.
    std::vector<float> cell_hardening;  // accumulated plastic strain
    // Mechanics of cells (laws/cell.h): inverse of the plastic stretch less one, xx, yy, zz, xy,
    // yz, zx, and plastic part of the modes xy, yz, zx, xyz, three components each [m].
    std::array<std::vector<float>, 6> cell_plastic_stretch;
    std::array<std::vector<float>, 12> cell_plastic_modes;
    // Mechanics of springs: logarithmic plastic strain that a cell gives each of its 24
    // connections, by slot (kCellConnection), then cell.
    std::array<std::vector<float>, kCellConnectionCount> cell_plastic;

    SurfacePoints surface;

    std::size_t particle_count() const { return particle_mass.size(); }
    const MixedCell* mixed_at(CellId cell) const;  // null: of one material
    const CellSet* set_of(CellId cell) const;      // null: none
    void lay_down(const CellSet& set);             // in its place, or for that of the same cell
    std::size_t material_count() const { return 1 + inset.size(); }
    const Material& material_at(std::size_t number) const {
        return number == 0 ? material : inset[number - 1];
    }
    const Material& material_of(CellId cell) const {
        return cell_material.empty() ? material : material_at(cell_material[cell]);
    }
    double mean_modulus() const;           // Young's, by volume [Pa]
    std::size_t connection_count() const;  // unsevered ones
    double volume() const;                 // of the material at molding [m3]
    double mass() const;                   // [kg]
    Vec3 centre() const;                   // of mass [m]
    Vec3 mean_velocity() const;            // of mass [m/s]
    Vec3 surface_position(std::size_t point) const;
    // Deformation gradient of the carrying cell's trilinear map at the point.
    Mat3 surface_gradient(std::size_t point) const;
    std::size_t bytes() const;  // of all arrays
};

inline double reference_length(const Lattice& lattice, int direction) {
    return lattice.spacing * (direction < kEdgeCount ? 1.0 : std::numbers::sqrt2);
}

// Derives runs, spans and corners from the set of active cells (a site each, sorted by z, y, x;
// no duplicates). Particle and cell arrays are not touched.
Lattice make_lattice(const Vec3& origin, double spacing, const Vec3i& cell_count,
                     const std::vector<Vec3i>& active_cells);

// Whether all 24 connections of the cell with these low row ends still hold. A cell that a blade
// has crossed is no longer a cell: its corners belong to different sides.
bool cell_is_whole(const Aggregate& matter, const std::array<ParticleId, 4>& row);

// Whether it is whole and has never reached its strength.
bool cell_is_sound(const Aggregate& matter, CellId cell, const std::array<ParticleId, 4>& row);

// Pieces connected through unsevered connections: piece[p] for each particle, numbered in order
// of their lowest particle.
struct Pieces {
    int count = 0;
    std::vector<int> particle_piece;
};
Pieces find_pieces(const Aggregate& matter);

// Hash of everything that a later stage depends on.
std::uint64_t state_hash(const Aggregate& matter);

}  // namespace swage
