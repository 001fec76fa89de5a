// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/moving_body.h"

#include <algorithm>
#include <cmath>

#include "sim/lattice_sweep.h"

namespace swage {

namespace {

double fastest(const Aggregate& matter, const std::vector<double>& bound) {
    double highest = 0;
    for (std::size_t p = 0; p < bound.size(); ++p) {
        highest = std::max(highest, bound[p] / matter.particle_mass[p]);
    }
    return std::sqrt(highest);
}

double highest_frequency(const Aggregate& matter, const LatticeForces& lattice) {
    return fastest(matter, lattice.stiffness_bound(matter));
}

double stable_step(const Aggregate& matter, const SimSettings& settings,
                   const LatticeForces& lattice, const DampingBranches& branches) {
    std::vector<double> bound = lattice.stiffness_bound(matter);
    if (branches.count > 0) {
        const std::vector<double> more = stiffness_bound(matter, lattice_law(matter));
        for (std::size_t p = 0; p < bound.size(); ++p) {
            bound[p] += (fast_stiffness(branches) - 1) * more[p];
        }
    }
    const double zeta = matter.material.damping_ratio;
    return settings.step_safety * 2 / fastest(matter, bound) * (std::sqrt(1 + zeta * zeta) - zeta);
}

}  // namespace

double explicit_step(const Aggregate& matter, const SimSettings& settings) {
    const LatticeForces lattice(matter);
    const DampingBranches branches =
        damping_branches(matter.material.damping_ratio, slowest_frequency(matter),
                         highest_frequency(matter, lattice));
    return stable_step(matter, settings, lattice, branches);
}

MovingBody::MovingBody(Aggregate& matter, int number, const Apparatus& apparatus,
                       const SimSettings& settings)
    : matter_(matter),
      lattice_(matter),
      damping_(matter, highest_frequency(matter, lattice_)),
      contacts_(matter, apparatus, settings, number),
      pushes_(apparatus, settings, number),
      step_(swage::stable_step(matter, settings, lattice_, damping_.branches())),
      drag_(matter, settings, step_),
      load_(apparatus.tool.size() + apparatus.grip.size()) {}

double MovingBody::elastic_energy() {
    return lattice_.elastic_energy(matter_) +
           (damping_.acts() ? damping_.stored_energy(matter_) : 0);
}

void MovingBody::find_candidates(const Drive& now) {
    contacts_.find_candidates(matter_, now);
    listed_ = matter_.particle_position;
}

void MovingBody::find_forces(const Drive& before, const Drive& now, double step,
                             BodyOutcome& outcome) {
    contacts_.begin_move(matter_, before);
    lattice_.find(matter_, Flow::trial, force_);
    if (damping_.acts()) outcome.damped_work += damping_.add_forces(matter_, step, force_);
    if (drag_.acts()) outcome.damped_work += step * drag_.add_forces(matter_, force_);
    contacts_.add_forces(matter_, now, force_);
    pushes_.add_forces(matter_, now, force_);
}

void MovingBody::move(const Drive& now, double step) {
    Vec3Array &x = matter_.particle_position, &v = matter_.particle_velocity;
    const Vec3 g = pushes_.gravity(now);
    for (std::size_t p = 0; p < x.size(); ++p) {
        const double push = step / matter_.particle_mass[p];
        v.x[p] += push * force_.x[p] + step * g.x();
        v.y[p] += push * force_.y[p] + step * g.y();
        v.z[p] += push * force_.z[p] + step * g.z();
        x.x[p] += step * v.x[p];
        x.y[p] += step * v.y[p];
        x.z[p] += step * v.z[p];
    }
}

bool MovingBody::is_finite() const {
    const Vec3Array& x = matter_.particle_position;
    double sum = 0;
    for (std::size_t p = 0; p < x.size(); ++p) sum += x.x[p] + x.y[p] + x.z[p];
    return std::isfinite(sum);
}

double MovingBody::travel() const {
    const Vec3Array& x = matter_.particle_position;
    double farthest = 0;
    for (std::size_t p = 0; p < x.size(); ++p) {
        farthest = std::max({farthest, std::abs(x.x[p] - listed_.x[p]),
                             std::abs(x.y[p] - listed_.y[p]), std::abs(x.z[p] - listed_.z[p])});
    }
    return farthest;
}

void MovingBody::commit(const Drive& before, const Drive& now, BodyOutcome& outcome) {
    const Committed lost = lattice_.commit(matter_);
    outcome.plastic_work += lost.plastic;
    outcome.fracture_work += lost.fracture;
    outcome.broken += lost.broken;
    outcome.fracture_work += lattice_.crack(matter_).lost;
    contacts_.commit(matter_, now);
    std::vector<LoadSum> load = contacts_.loads(matter_, now);
    add_work(before, now, load_, load, outcome.work);
    pushes_.commit(matter_, now, outcome.push_work);
    load_ = std::move(load);
}

struct MovingBody::State {
    Vec3Array position, velocity;
    std::array<ConnectionArrays, kForwardCount> connection;
    std::array<std::vector<float>, kCellConnectionCount> plastic;
    std::vector<char> cracked;
    std::array<std::vector<float>, 6> strain;
    std::array<std::vector<float>, 12> modes;
    std::vector<float> hardening;
    std::vector<MixedCell> mixed;
    ContactSet contacts;
    LoadSet pushes;
    InternalDamping damping;
    std::vector<LoadSum> load;
};

std::shared_ptr<const MovingBody::State> MovingBody::save() const {
    const Aggregate& m = matter_;
    return std::make_shared<const State>(
        State{m.particle_position, m.particle_velocity, m.connection, m.cell_plastic,
              m.cell_cracked, m.cell_plastic_strain, m.cell_plastic_modes, m.cell_hardening,
              m.mixed_cell, contacts_, pushes_, damping_, load_});
}

void MovingBody::restore(const State& state) {
    matter_.particle_position = state.position;
    matter_.particle_velocity = state.velocity;
    matter_.connection = state.connection;
    matter_.cell_plastic = state.plastic;
    matter_.cell_cracked = state.cracked;
    matter_.cell_plastic_strain = state.strain;
    matter_.cell_plastic_modes = state.modes;
    matter_.cell_hardening = state.hardening;
    matter_.mixed_cell = state.mixed;
    contacts_ = state.contacts;
    pushes_ = state.pushes;
    damping_ = state.damping;
    load_ = state.load;
    lattice_.connections_changed(matter_);
}

}  // namespace swage
