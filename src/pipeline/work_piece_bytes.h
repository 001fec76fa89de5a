// SPDX-License-Identifier: GPL-3.0-or-later
// A work-piece as bytes (base/bytes.h): all of it, but for what is derived from the rest.
#pragma once

#include "pipeline/mesh_bytes.h"
#include "pipeline/work_piece.h"

namespace swage {

template <typename Io>
void visit(Io& io, FlowPoint& point) {
    auto& [strain, stress] = point;
    io(strain, stress);
}
template <typename Io>
void visit(Io& io, Material& material) {
    auto& [name, mechanics, elasticity, young_modulus, poisson_ratio, density, yield_stress,
           hardening, flow_curve, back_stress, back_strain, strength, toughness, damping_ratio,
           friction, static_friction, restitution, stickiness] = material;
    io(name, mechanics, elasticity, young_modulus, poisson_ratio, density, yield_stress, hardening,
       flow_curve, back_stress, back_strain, strength, toughness, damping_ratio, friction,
       static_friction, restitution, stickiness);
}

template <typename Io>
void visit(Io& io, ParticleRun& run) {
    auto& [i, j, k, first, count] = run;
    io(i, j, k, first, count);
}
template <typename Io>
void visit(Io& io, Span& span) {
    auto& [direction, lower, upper, count] = span;
    io(direction, lower, upper, count);
}
template <typename Io>
void visit(Io& io, CellRun& run) {
    auto& [i, j, k, first, count, row] = run;
    io(i, j, k, first, count, row);
}
template <typename Io>
void visit(Io& io, Lattice& lattice) {
    auto& [origin, spacing, cell_count, particle_run, span, cell_run, cell_row_begin] = lattice;
    io(origin, spacing, cell_count, particle_run, span, cell_run, cell_row_begin);
}

template <typename Io>
void visit(Io& io, ConnectionArrays& arrays) {
    auto& [weight, plastic, damage] = arrays;
    io(weight, plastic, damage);
}
template <typename Io>
void visit(Io& io, CellHistories& histories) {
    auto& [row] = histories;
    io(row);
}
template <typename Io>
void visit(Io& io, CellBackStrains& back) {
    auto& [row] = back;
    io(row);
}
template <typename Io>
void visit(Io& io, MixedCell& mixed) {
    auto& [cell, material, fill, centroid, normal, flowed, jump] = mixed;
    io(cell, material, fill, centroid, normal, flowed, jump);
}
template <typename Io>
void visit(Io& io, CellSet& set) {
    auto& [cell, strain] = set;
    io(cell, strain);
}
template <typename Io>
void visit(Io& io, DampingBranches& branches) {
    auto& [count, share, time] = branches;
    io(count, share, time);
}
template <typename Io>
void visit(Io& io, BranchMemory& memory) {
    auto& [branches, strain] = memory;
    io(branches, strain);
}
template <typename Io>
void visit(Io& io, Aggregate& matter) {
    auto& [material, lattice, particle_reference, particle_position, particle_velocity,
           particle_mass, connection, cell_fill, cell_centroid, inset, cell_material, mixed_cell,
           cell_cracked, cell_set, cell_history, cell_back, cell_plastic, branch_memory, cut,
           surface] = matter;
    io(material, lattice, particle_reference, particle_position, particle_velocity, particle_mass,
       connection, cell_fill, cell_centroid, inset, cell_material, mixed_cell, cell_cracked,
       cell_set, cell_history, cell_back, cell_plastic, branch_memory, cut, surface);
}

// What finish_mount derives is left to it.
template <typename Io>
void visit(Io& io, Mount& mount) {
    auto& [kind, reference, cell, side, hold, group, vertex, carrier, particle, stencil] = mount;
    io(kind, reference, cell, side, hold);
}

template <typename Io>
void visit(Io& io, CarriedInset& inset) {
    auto& [mesh, mount, position, is_torn, look] = inset;
    io(mesh, mount, position, is_torn, look);
}

template <typename Io>
void visit(Io& io, WorkPiece& piece) {
    auto& [name, label, matter, skin, mount, look, position, followed, finding, probe, is_torn,
           is_parted, roughness, whole_skin, whole_mount, whole_position, insets] = piece;
    io(name, label, matter, skin, mount, probe);
    std::optional<TriMesh> like;
    if (look) like = look->mesh();
    io(like, position, followed, finding, is_torn, is_parted, roughness, whole_skin, whole_mount,
       whole_position, insets);
    if constexpr (Io::kReads) {
        if (like) look = std::make_shared<const NewLook>(*like);
        finish_mount(mount, matter);
        finish_mount(probe, matter);
        if (whole_skin) finish_mount(whole_mount, matter);
        for (CarriedInset& one : insets) finish_mount(one.mount, matter);
    }
}

}  // namespace swage
