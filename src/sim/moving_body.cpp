// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/moving_body.h"

#include <algorithm>
#include <cmath>

#include "sim/cell_volume.h"
#include "sim/lattice_sweep.h"
#include "sim/vector_sums.h"

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

constexpr double kCalm = 0.5;  // of the speed that crushed matter deforms by, in a stable step

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
      load_(apparatus.tool.size() + apparatus.grip.size()),
      touches_(!apparatus.tool.empty()),
      remembers_(false) {
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        const Material& material = matter.material_at(m);
        remembers_ = remembers_ || material.breaks() || std::isfinite(material.yield_stress);
    }
}

double MovingBody::elastic_energy() {
    return lattice_.elastic_energy(matter_) +
           (damping_.acts() ? damping_.stored_energy(matter_) : 0);
}

void MovingBody::start(const Drive& from, BodyOutcome& outcome) {
    pushes_.start(matter_, from);
    find_candidates(from);
    begin_step(from);
    find_forces(from, 0, outcome);
    load_ = contacts_.loads(matter_, from);
}

void MovingBody::find_candidates(const Drive& now) {
    contacts_.find_candidates(matter_, now);
    if (touches_) listed_ = matter_.particle_position;
    gone_ = 0;
}

void MovingBody::renew_candidates(const Drive& before, const Drive& now, double way) {
    if (!touches_) return;
    const double far = 0.45 * matter_.lattice.spacing;
    gone_ += way + contacts_.travel(matter_, before, now);
    if (gone_ > far) find_candidates(now);
}

double MovingBody::move(double kick, double step) {
    Vec3Array &x = matter_.particle_position, &v = matter_.particle_velocity;
    std::vector<double> fastest(vector_chunks(x.size()));
    for_each_chunk(x.size(), [&](std::size_t begin, std::size_t end) {
        double most = 0, wrong = 0;  // wrong: 0 while all is finite
        for (std::size_t p = begin; p < end; ++p) {
            const double push = kick / matter_.particle_mass[p];
            v.x[p] += push * force_.x[p] + kick * gravity_.x();
            v.y[p] += push * force_.y[p] + kick * gravity_.y();
            v.z[p] += push * force_.z[p] + kick * gravity_.z();
            x.x[p] += step * v.x[p];
            x.y[p] += step * v.y[p];
            x.z[p] += step * v.z[p];
            const double speed = v.x[p] * v.x[p] + v.y[p] * v.y[p] + v.z[p] * v.z[p];
            most = speed > most ? speed : most;
            wrong += speed - speed;
        }
        fastest[begin / kVectorChunk] = most + wrong;
    });
    double most = 0;
    for (double one : fastest) most = std::isnan(one) ? one : std::max(one, most);
    return step * std::sqrt(most);
}

void MovingBody::find_forces(const Drive& now, double step, BodyOutcome& outcome) {
    inside_out_ = lattice_.find(matter_, Flow::trial, force_);
    if (damping_.acts()) outcome.damped_work += damping_.add_forces(matter_, step, force_);
    if (drag_.acts()) outcome.drag_work += step * drag_.add_forces(matter_, force_);
    contacts_.add_forces(matter_, now, force_);
    pushes_.add_forces(matter_, now, force_);
    gravity_ = pushes_.gravity(now);
}

void MovingBody::finish_step(const Drive& before, const Drive& now, double step,
                             BodyOutcome& outcome) {
    if (lattice_.saw_crushed() || inside_out_ > 0) {
        outcome.damped_work += calm_crushed(matter_, std::exp(-kCalm * step / step_));
    }
    if (remembers_) {
        const Committed lost = lattice_.commit(matter_);
        outcome.plastic_work += lost.plastic;
        outcome.fracture_work += lost.fracture;
        outcome.broken += lost.broken;
        const Cracked cracked = lattice_.crack(matter_);
        outcome.fracture_work += cracked.lost;
        if (cracked.cells > 0) find_forces(now, 0, outcome);
    }
    outcome.friction_work += contacts_.commit(matter_, now);
    std::vector<LoadSum> load = contacts_.loads(matter_, now);
    add_work(before, now, load_, load, outcome.work);
    pushes_.commit(matter_, now, outcome.push_work);
    load_ = std::move(load);
}

Stored MovingBody::stored(const Drive& now, double step) {
    const Vec3Array& v = matter_.particle_velocity;
    Stored held;
    held.elastic = elastic_energy();
    held.contact = contacts_.stored_energy(matter_, now);
    const double half = 0.5 * step;
    held.kinetic = chunked_sum(v.size(), [&](std::size_t p) {
        return 0.5 * matter_.particle_mass[p] *
               (v.at(p).squaredNorm() - (half * acceleration(p)).squaredNorm());
    });
    return held;
}

std::vector<double> MovingBody::stiffness_bound() const {
    std::vector<double> bound = lattice_.stiffness_bound(matter_);
    contacts_.add_stiffness(matter_, bound);
    return bound;
}

double MovingBody::top_speed() const {
    const Vec3Array& v = matter_.particle_velocity;
    double most = 0;
    for (std::size_t p = 0; p < v.size(); ++p) most = std::max(most, v.at(p).squaredNorm());
    return std::sqrt(most);
}

void MovingBody::count_inside_out() {
    if (!lattice_.sees_inside_out(matter_)) inside_out_ = swage::count_inside_out(matter_);
}

double MovingBody::present_step() {
    if (inside_out_ == 0) return step_;
    std::vector<double> guard(matter_.particle_count(), 0.0);
    add_guard_stiffness(matter_, guard);
    double highest = 0;
    for (std::size_t p = 0; p < guard.size(); ++p) {
        highest = std::max(highest, guard[p] / matter_.particle_mass[p]);
    }
    return 1 / std::sqrt(1 / (step_ * step_) + 0.25 * highest);
}

void MovingBody::save(State& state) const {
    const Aggregate& m = matter_;
    state.position = m.particle_position;
    state.velocity = m.particle_velocity;
    if (remembers_) {
        state.connection = m.connection;
        state.plastic = m.cell_plastic;
        state.cracked = m.cell_cracked;
        state.strain = m.cell_plastic_strain;
        state.modes = m.cell_plastic_modes;
        state.hardening = m.cell_hardening;
        state.mixed = m.mixed_cell;
    }
    state.contacts.assign(1, contacts_);
    state.pushes.assign(1, pushes_);
    state.damping.assign(1, damping_);
    state.load = load_;
}

void MovingBody::restore(const State& state) {
    matter_.particle_position = state.position;
    matter_.particle_velocity = state.velocity;
    if (remembers_) {
        matter_.connection = state.connection;
        matter_.cell_plastic = state.plastic;
        matter_.cell_cracked = state.cracked;
        matter_.cell_plastic_strain = state.strain;
        matter_.cell_plastic_modes = state.modes;
        matter_.cell_hardening = state.hardening;
        matter_.mixed_cell = state.mixed;
        lattice_.connections_changed(matter_);
    }
    contacts_ = state.contacts[0];
    pushes_ = state.pushes[0];
    damping_ = state.damping[0];
    load_ = state.load;
}

}  // namespace swage
