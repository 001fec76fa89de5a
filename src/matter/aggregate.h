// SPDX-License-Identifier: GPL-3.0-or-later
// A body of matter: particles on a cubic lattice and the connections between neighbours, as arrays
// by component. No law is called here.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/math.h"
#include "base/sparse_array.h"
#include "laws/internal_damping.h"
#include "matter/lattice.h"
#include "matter/material.h"
#include "matter/surface_points.h"

namespace swage {

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

// Where a blade crossed a connection that it severed.
struct CutPoint {
    using IsPlain = CutPoint;
    std::array<float, 3> place;   // at molding, from the lattice's origin [spacings]
    std::array<float, 3> normal;  // of the blade's path there, at molding: unit, to either side
};

// Numbers of a cell's history (laws/cell.h), in this order: inverse of the plastic stretch less
// one, xx, yy, zz, xy, yz, zx; plastic part of the modes xy, yz, zx, xyz, three components each
// [m]; hardening, which is accumulated plastic strain.
inline constexpr int kCellHistory = 19;

// The committed history of all cells, a row for each of its numbers. Mechanics of springs keep the
// hardening alone, and the rest is empty.
struct CellHistories {
    std::array<std::vector<float>, kCellHistory> row;

    std::vector<float>& hardening() { return row.back(); }
    const std::vector<float>& hardening() const { return row.back(); }
    bool empty() const { return hardening().empty(); }
    float hardening_of(CellId cell) const { return empty() ? 0 : hardening()[cell]; }
    void assign(std::size_t cells) {  // none has flowed
        for (std::vector<float>& v : row) v.assign(cells, 0.0f);
    }
    void clear() {
        for (std::vector<float>& v : row) v.clear();
    }
};

// Numbers of a cell's back stress (laws/cell_back.h), in this order: its strain, xx, yy, zz, xy,
// yz, zx; of the modes as above [m].
inline constexpr int kCellBack = 18;

struct CellBackStrains {
    std::array<std::vector<float>, kCellBack> row;

    bool empty() const { return row[0].empty(); }
    void assign(std::size_t cells) {
        for (std::vector<float>& v : row) v.assign(cells, 0.0f);
    }
    void clear() {
        for (std::vector<float>& v : row) v.clear();
    }
};

// What has flowed in each of the materials of a cell of two, committed.
using MixedHistory = std::array<std::array<float, kCellHistory>, 2>;

// A cell through which the boundary of two materials runs.
struct MixedCell {
    CellId cell;
    std::array<std::uint8_t, 2> material;     // as cell_material
    std::array<float, 2> fill;                // shares of the cell's volume
    std::array<Eigen::Vector3f, 2> centroid;  // of these, in the cell, each -0.5 to 0.5
    Eigen::Vector3f normal;                   // of the boundary between them, unit
    MixedHistory flowed{};
    // By what the gradient's part along the normal jumps there, committed as what has flowed is: it
    // is sought from here (laws/laminate.h). None while nothing has flowed.
    Vec3 jump = Vec3::Zero();

    float hardening() const { return std::max(flowed[0].back(), flowed[1].back()); }
};

// What the connections of a cell are at rest with, beside what has flowed: l' = (1 + strain) l.
struct CellSet {
    CellId cell;
    std::array<float, kCellConnectionCount> strain;
};

// What the internal damping of one of a body's damping ratios remembers (sim/internal_damping.h).
struct BranchMemory {
    DampingBranches branches;
    std::vector<float> strain;  // tension over stiffness and length, as LatticeSweep keeps it
};

struct Aggregate {
    // Compiled once: a copy is thousands of instructions, which many places make.
    Aggregate();
    ~Aggregate();
    Aggregate(const Aggregate&);
    Aggregate(Aggregate&&) noexcept;
    Aggregate& operator=(const Aggregate&);
    Aggregate& operator=(Aggregate&&) noexcept;

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

    // Of cells of one material; empty while none of these has ever yielded.
    CellHistories cell_history;
    // Committed back stress; empty where no material has one, and while none has yielded.
    CellBackStrains cell_back;
    // Mechanics of springs: logarithmic plastic strain that a cell gives each of its 24
    // connections, by slot (kCellConnection), then cell. Empty likewise.
    std::array<std::vector<float>, kCellConnectionCount> cell_plastic;

    std::vector<BranchMemory> branch_memory;  // empty: it has come to rest

    std::vector<CutPoint> cut;  // of all blades, in the order in which they severed

    SurfacePoints surface;

    std::size_t particle_count() const { return particle_mass.size(); }
    const MixedCell* mixed_at(CellId cell) const;  // null: of one material
    const CellSet* set_of(CellId cell) const;      // null: none
    void lay_down(const CellSet& set);             // in its place, or for that of the same cell
    std::size_t material_count() const { return 1 + inset.size(); }
    const Material& material_at(std::size_t number) const {
        return number == 0 ? material : inset[number - 1];
    }
    std::size_t material_number(CellId cell) const {
        return cell_material.empty() ? 0 : cell_material[cell];
    }
    const Material& material_of(CellId cell) const { return material_at(material_number(cell)); }
    bool breaks() const;                    // any of its materials
    bool yields() const;                    // likewise
    bool has_flowed() const;                // cells of two materials included
    float hardening_of(CellId cell) const;  // of two materials in it the more
    double mean_modulus() const;            // Young's, by volume [Pa]
    std::size_t connection_count() const;   // unsevered ones
    double volume() const;                  // of the material at molding [m3]
    double mass() const;                    // [kg]
    Vec3 centre() const;                    // of mass [m]
    Vec3 mean_velocity() const;             // of mass [m/s]
    Vec3 surface_position(std::size_t point) const {
        return surface.position(point, particle_position);
    }
    Vec3 surface_reference(std::size_t point) const {  // the same at molding
        return surface.reference(point, particle_reference);
    }
    // Deformation gradient of the carrying cell's trilinear map at the point.
    Mat3 surface_gradient(std::size_t point) const;
    std::size_t bytes() const;  // of all arrays
};

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

    template <typename Io>
    void visit(Io& io) {
        io(count, particle_piece);
    }
};
Pieces find_pieces(const Aggregate& matter);

// Hash of the particles, their connections, and what cells and damping remember. Of what molding
// makes for good the cells' shares and boundaries, the surface, lattice and materials are left out.
std::uint64_t state_hash(const Aggregate& matter);

}  // namespace swage
