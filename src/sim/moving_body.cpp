// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/moving_body.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/parallel.h"
#include "sim/cell_batch.h"
#include "sim/lattice_sweep.h"
#include "sim/vector_clones.h"

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

constexpr std::size_t kMoved = 2048;  // particles at a time, so that they stay in a near cache

struct Movers {
    double *x[3], *v[3];
    const double *f[3], *mass, *listed[3];
};

// What particles have moved at most, by component; NaN where any is lost.
SWAGE_VECTOR_CLONES
double move_block(const Movers& m, std::size_t begin, std::size_t end, double dt,
                  const double* fall) {
    Lanes farthest{}, wrong{};  // wrong: stays 0 while all is finite
    const auto batch = [&](const Movers& at, std::size_t p) __attribute__((always_inline)) {
        const Lanes push = dt / load<Lanes>(at.mass + p);
        for (int i = 0; i < 3; ++i) {
            const Lanes v =
                load<Lanes>(at.v[i] + p) + (push * load<Lanes>(at.f[i] + p) + dt * fall[i]);
            const Lanes x = load<Lanes>(at.x[i] + p) + dt * v;
            std::memcpy(at.v[i] + p, &v, sizeof v);
            std::memcpy(at.x[i] + p, &x, sizeof x);
            wrong += x - x;
            const Lanes way = x - load<Lanes>(at.listed[i] + p);
            farthest = larger(farthest, way > 0.0 ? way : -way);
        }
    };
    for (; begin + kLanes <= end; begin += kLanes) batch(m, begin);
    if (begin < end) {
        double copy[13][kLanes];
        Movers last;
        const std::size_t count = end - begin;
        const auto take = [&](int n, const double* from, double fill) {
            std::fill_n(copy[n], kLanes, fill);
            std::copy_n(from + begin, count, copy[n]);
            return copy[n];
        };
        for (int i = 0; i < 3; ++i) {
            last.x[i] = take(i, m.x[i], 0), last.v[i] = take(3 + i, m.v[i], 0);
            last.f[i] = take(6 + i, m.f[i], 0), last.listed[i] = take(9 + i, m.listed[i], 0);
        }
        last.mass = take(12, m.mass, 1);
        batch(last, 0);
        for (int i = 0; i < 3; ++i) {
            std::copy_n(copy[i], count, m.x[i] + begin);
            std::copy_n(copy[3 + i], count, m.v[i] + begin);
        }
    }
    double most = 0, sum = 0;
    for (int l = 0; l < kLanes; ++l) most = std::max(most, farthest[l]), sum += wrong[l];
    return sum == 0 ? most : std::numeric_limits<double>::quiet_NaN();
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
      remembers_(matter.material.breaks()),
      load_(apparatus.tool.size() + apparatus.grip.size()) {
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        remembers_ = remembers_ || std::isfinite(matter.material_at(m).yield_stress);
    }
}

double MovingBody::branch_energy() {
    return damping_.acts() ? damping_.stored_energy(matter_, lattice_.sweep(matter_)) : 0;
}

double MovingBody::elastic_energy() { return lattice_.elastic_energy(matter_) + branch_energy(); }

void MovingBody::find_candidates(const Drive& now) {
    contacts_.find_candidates(matter_, now);
    listed_ = matter_.particle_position;
    farthest_ = 0;
}

// Of the lattice and its damping.
void MovingBody::find_inner_forces(double step, BodyOutcome& outcome) {
    if (!damping_.acts()) {
        lattice_.find(matter_, Flow::trial, force_);
        return;
    }
    const BranchStep branches = damping_.step(lattice_.sweep(matter_), step);
    lattice_.find(matter_, Flow::trial, force_, &branches, &outcome.damped_work);
}

// What flows, softens and cracks at the present positions, whose forces were just found. Where it
// changes who pulls, they are found anew.
void MovingBody::remember(BodyOutcome& outcome) {
    if (!remembers_) return;
    const Committed lost = lattice_.commit(matter_);
    outcome.plastic_work += lost.plastic;
    outcome.fracture_work += lost.fracture;
    outcome.broken += lost.broken;
    const Cracked cracked = lattice_.crack(matter_, true);
    outcome.fracture_work += cracked.lost;
    if (lost.broken > 0 || cracked.cells > 0) find_inner_forces(0, outcome);
}

// What is done on the branches of the damping and they do not store is lost.
void MovingBody::begin_steps(const Drive& from, BodyOutcome& outcome) {
    find_candidates(from);
    outcome.damped_work += branch_energy();
}

void MovingBody::end_steps(BodyOutcome& outcome) {
    if (remembers_) {
        find_inner_forces(0, outcome);
        remember(outcome);
    }
    outcome.damped_work -= branch_energy();
}

void MovingBody::find_forces(const Drive& before, const Drive& now, double step,
                             BodyOutcome& outcome) {
    contacts_.begin_move(matter_, before);
    find_inner_forces(step, outcome);
    remember(outcome);
    if (drag_.acts()) outcome.damped_work += step * drag_.add_forces(matter_, force_);
    contacts_.add_forces(matter_, now, force_);
    pushes_.add_forces(matter_, now, force_);
}

bool MovingBody::move(const Drive& now, double step) {
    Vec3Array &x = matter_.particle_position, &v = matter_.particle_velocity;
    const Vec3Array& f = force_;
    const Movers movers{{x.x.data(), x.y.data(), x.z.data()},
                        {v.x.data(), v.y.data(), v.z.data()},
                        {f.x.data(), f.y.data(), f.z.data()},
                        matter_.particle_mass.data(),
                        {listed_.x.data(), listed_.y.data(), listed_.z.data()}};
    const Vec3 g = pushes_.gravity(now);
    const double fall[3] = {g.x(), g.y(), g.z()};
    std::vector<double> farthest((x.size() + kMoved - 1) / kMoved);
    parallel_for(farthest.size(), [&](std::size_t chunk) {
        farthest[chunk] = move_block(movers, chunk * kMoved,
                                     std::min(x.size(), (chunk + 1) * kMoved), step, fall);
    });
    farthest_ = 0;
    for (double one : farthest) {
        if (std::isnan(one)) return false;
        farthest_ = std::max(one, farthest_);
    }
    return true;
}

void MovingBody::commit(const Drive& before, const Drive& now, BodyOutcome& outcome) {
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
