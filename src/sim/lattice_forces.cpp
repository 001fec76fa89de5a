// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/lattice_forces.h"

#include <algorithm>
#include <cmath>

#include "laws/spring_damper.h"
#include "sim/cell_volume.h"

namespace swage {

namespace {

// Ratio of the lengths that a connection of this direction has after the cell's plastic strain.
double rest_ratio(const Aggregate& matter, CellId cell, int direction) {
    const auto& e = matter.cell_plastic_strain;
    if (e[0].empty()) return 1;
    const auto& f = kForward[direction];
    const Vec3 n = Vec3(f[0], f[1], f[2]).normalized();
    const double strain =
        n.x() * n.x() * e[0][cell] + n.y() * n.y() * e[1][cell] + n.z() * n.z() * e[2][cell] +
        2 * (n.x() * n.y() * e[3][cell] + n.y() * n.z() * e[4][cell] + n.z() * n.x() * e[5][cell]);
    return std::exp(strain);
}

}  // namespace

LatticeForces::LatticeForces(const Aggregate& matter)
    : spring_law_(lattice_law(matter)), spring_sweep_(matter) {
    const bool springs = matter.material.mechanics == Mechanics::springs;
    if (!springs) cells_ = std::make_unique<CellSweep>(matter);
    if (springs && std::isfinite(matter.material.yield_stress)) {
        spring_flow_ = std::make_unique<CellFlow>(matter);
    }
    guarded_ = springs;
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        guarded_ = guarded_ || matter.material_at(m).elasticity != Elasticity::neo_hookean;
    }
    connections_changed(matter);
}

void LatticeForces::connections_changed(const Aggregate& matter) {
    if (!cells_) return;
    cells_->cells_changed(matter);
    loose_.clear();
    // Each cell that is not whole gives its share of what its connections have left.
    auto mixed = matter.mixed_cell.begin();
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const CellId cell = run.first + n;
            double stiffness =
                lattice_stiffness(matter.material_of(cell).young_modulus, matter.lattice.spacing) *
                matter.cell_fill[cell];
            if (mixed != matter.mixed_cell.end() && mixed->cell == cell) {
                stiffness = 0;
                for (int m : {0, 1}) {
                    const Material& material = matter.material_at(mixed->material[m]);
                    stiffness += mixed->fill[m] *
                                 lattice_stiffness(material.young_modulus, matter.lattice.spacing);
                }
                ++mixed;
            }
            if (cells_->carried_fill()[cell] > 0) continue;
            for (const CellConnection& c : kCellConnection) {
                const ParticleId lower = run.row[c.corner >> 1] + n + (c.corner & 1);
                if (matter.connection[c.direction].weight[lower] <= 0) continue;
                const auto& f = kForward[c.direction];
                const int high = c.corner + f[0] + 2 * f[1] + 4 * f[2];
                const ParticleId upper = run.row[high >> 1] + n + (high & 1);
                const double share = c.direction < kEdgeCount ? 0.25 : 0.5;
                loose_.push_back({lower, upper, stiffness * share,
                                  reference_length(matter.lattice, c.direction) *
                                      rest_ratio(matter, cell, c.direction)});
            }
        }
    }
}

void LatticeForces::add_loose(const Aggregate& matter, Vec3Array& force) const {
    const Vec3Array& x = matter.particle_position;
    for (const LooseSpring& s : loose_) {
        const Vec3 reach = x.at(s.upper) - x.at(s.lower);
        const double distance = reach.norm();
        const double tension =
            spring_tension(SpringDamper{s.stiffness, 0, s.rest_length}, distance, 0.0);
        const Vec3 pull = tension / (distance + 1e-300) * reach;
        force.add(s.lower, pull);
        force.add(s.upper, -pull);
    }
}

int LatticeForces::find(const Aggregate& matter, Flow flow, Vec3Array& force) {
    if (cells_) {
        cells_->forces(matter, flow, force);
        add_loose(matter, force);
        return guarded_ ? add_guard_forces(matter, cells_->crushed_runs(), force) : 0;
    }
    const bool flows = spring_flow_ && flow == Flow::trial;
    spring_sweep_.forces(matter, spring_law_, flows ? &spring_flow_->rest_strains(matter) : nullptr,
                         force);
    return add_guard_forces(matter, force);
}

double LatticeForces::commit(Aggregate& matter) {
    if (cells_) return cells_->commit(matter);
    return spring_flow_ ? spring_flow_->commit(matter) : 0;
}

double LatticeForces::elastic_energy(const Aggregate& matter) const {
    double sum = guarded_ ? guard_energy_of(matter) : 0;
    if (!cells_) return sum + swage::elastic_energy(matter, spring_law_);
    sum += cells_->elastic_energy(matter);
    const Vec3Array& x = matter.particle_position;
    for (const LooseSpring& s : loose_) {
        sum += spring_energy(SpringDamper{s.stiffness, 0, s.rest_length},
                             (x.at(s.upper) - x.at(s.lower)).norm());
    }
    return sum;
}

std::vector<double> LatticeForces::stiffness_bound(const Aggregate& matter) const {
    if (!cells_) return swage::stiffness_bound(matter, spring_law_);
    std::vector<double> bound(matter.particle_count(), 0.0);
    cells_->add_stiffness_bound(matter, bound);
    for (const LooseSpring& s : loose_) {
        bound[s.lower] += 2 * s.stiffness;
        bound[s.upper] += 2 * s.stiffness;
    }
    return bound;
}

}  // namespace swage
