// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/explicit_steps.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
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

bool finite(const Vec3Array& a) {
    double sum = 0;
    for (std::size_t p = 0; p < a.size(); ++p) sum += a.x[p] + a.y[p] + a.z[p];
    return std::isfinite(sum);
}

}  // namespace

double explicit_step(const Aggregate& matter, const SimSettings& settings) {
    const LatticeForces lattice(matter);
    const DampingBranches branches =
        damping_branches(matter.material.damping_ratio, slowest_frequency(matter),
                         highest_frequency(matter, lattice));
    return stable_step(matter, settings, lattice, branches);
}

ExplicitSolver::ExplicitSolver(Aggregate& matter, const Apparatus& apparatus,
                               const SimSettings& settings)
    : matter_(matter),
      apparatus_(apparatus),
      settings_(settings),
      lattice_(matter),
      damping_(matter, highest_frequency(matter, lattice_)),
      contacts_(matter, apparatus, settings),
      pushes_(apparatus, settings),
      step_(stable_step(matter, settings, lattice_, damping_.branches())),
      drag_(matter, settings, step_),
      load_(apparatus.tool.size() + apparatus.grip.size()) {
    contacts_.limit_stiffness(matter, step_);
}

void ExplicitSolver::connections_changed() {
    lattice_.connections_changed(matter_);  // fewer are never faster, so the step stays
}

bool ExplicitSolver::steps(const Drive& from, const Drive& to, double dt, MoveOutcome& outcome) {
    const double duration = to.time - from.time;
    const long count = std::max(1L, static_cast<long>(std::ceil(duration / dt)));
    dt = duration / static_cast<double>(count);
    Vec3Array &x = matter_.particle_position, &v = matter_.particle_velocity;
    Vec3Array listed = x;
    contacts_.find_candidates(matter_, from);
    Drive before = from;
    for (long n = 1; n <= count; ++n) {
        const Drive now = n == count ? to : drive_between(from, to, double(n) / double(count));
        contacts_.begin_move(matter_, before);
        lattice_.find(matter_, Flow::trial, force_);
        if (damping_.acts()) outcome.damped_work += damping_.add_forces(matter_, dt, force_);
        if (drag_.acts()) outcome.damped_work += dt * drag_.add_forces(matter_, force_);
        contacts_.add_forces(matter_, now, force_);
        pushes_.add_forces(matter_, now, force_);
        const Vec3 g = pushes_.gravity(now);
        double farthest = 0;
        for (std::size_t p = 0; p < x.size(); ++p) {
            const double push = dt / matter_.particle_mass[p];
            v.x[p] += push * force_.x[p] + dt * g.x();
            v.y[p] += push * force_.y[p] + dt * g.y();
            v.z[p] += push * force_.z[p] + dt * g.z();
            x.x[p] += dt * v.x[p];
            x.y[p] += dt * v.y[p];
            x.z[p] += dt * v.z[p];
            farthest = std::max({farthest, std::abs(x.x[p] - listed.x[p]),
                                 std::abs(x.y[p] - listed.y[p]), std::abs(x.z[p] - listed.z[p])});
        }
        if (!finite(x)) return false;
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
        const double tool_way = contacts_.travel(matter_, before, now) * double(n);
        if (farthest + tool_way > 0.45 * matter_.lattice.spacing) {
            contacts_.find_candidates(matter_, now);
            listed = x;
        }
        before = now;
    }
    outcome.steps += count;
    return true;
}

MoveOutcome ExplicitSolver::advance(const Drive& from, const Drive& to) {
    MoveOutcome outcome;
    const Vec3Array start_x = matter_.particle_position, start_v = matter_.particle_velocity;
    const auto start_connections = matter_.connection;
    const auto start_plastic = matter_.cell_plastic;
    const auto start_cracked = matter_.cell_cracked;
    const auto start_strain = matter_.cell_plastic_strain;
    const auto start_modes = matter_.cell_plastic_modes;
    const auto start_hardening = matter_.cell_hardening;
    const auto start_mixed = matter_.mixed_cell;
    const ContactSet start_contacts = contacts_;
    pushes_.start(matter_, from);
    const LoadSet start_pushes = pushes_;
    const InternalDamping start_damping = damping_;
    double dt = step_;
    for (;; dt *= 0.5, ++outcome.halvings) {
        outcome.work.assign(load_.size(), 0.0);
        outcome.push_work.assign(pushes_.count(), 0.0);
        outcome.plastic_work = outcome.damped_work = outcome.fracture_work = 0;
        outcome.broken = 0;
        if (steps(from, to, dt, outcome)) break;
        matter_.particle_position = start_x;
        matter_.particle_velocity = start_v;
        matter_.connection = start_connections;
        matter_.cell_plastic = start_plastic;
        matter_.cell_cracked = start_cracked;
        matter_.cell_plastic_strain = start_strain;
        matter_.cell_plastic_modes = start_modes;
        matter_.cell_hardening = start_hardening;
        matter_.mixed_cell = start_mixed;
        contacts_ = start_contacts;
        pushes_ = start_pushes;
        damping_ = start_damping;
        lattice_.connections_changed(matter_);
        if (outcome.halvings == settings_.halving_limit) {
            fail(ExitCode::stopped,
                 "{}: the motion is not finite at {:.4g} s even with steps of {:.3g} s; move the "
                 "tools slower (a longer duration) or use solver = \"quasistatic\"",
                 apparatus_.name, to.time, dt);
        }
    }
    outcome.load = load_;
    outcome.drag_held = drag_.is_held();
    return outcome;
}

}  // namespace swage
