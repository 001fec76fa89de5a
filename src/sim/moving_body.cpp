// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/moving_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/portable_math.h"
#include "sim/crushed_cells.h"
#include "sim/elasticity_of.h"
#include "sim/free_flight.h"
#include "sim/lane_memory.h"
#include "sim/vector_clones.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

double stable_step(const Aggregate& matter, double safety, const LatticeForces& lattice,
                   const SwingBound& swings, const InternalDamping& damping) {
    std::vector<double> damped(matter.particle_count(), 0.0);
    damping.add_stiffness_bound(matter, damped);
    const double branches = most_per_mass(damped, matter);
    const double zeta = largest_damping_ratio(matter);
    return safety * 2 / std::sqrt(swings.squared(matter, lattice) + branches) *
           (std::sqrt(1 + zeta * zeta) - zeta);
}

constexpr double kLost = std::numeric_limits<double>::quiet_NaN();
constexpr double kCalm = 0.5;      // of the speed that crushed matter deforms by, in a stable step
constexpr double kStirred = 1e-6;  // spacings
constexpr double kTurned = 0.05;   // spacings that particles go between looks at what is bent

struct Movers {
    double *x[3], *v[3];
    const double *f[3], *mass;
};

// The square of the highest speed among particles that are moved on; NaN where any is lost.
SWAGE_VECTOR_CLONES
double move_block(const Movers& m, std::size_t begin, std::size_t end, double kick, double step,
                  const double* fall) {
    FewLanes fastest{}, wrong{};  // wrong: stays 0 while all is finite
    const auto batch = [&](const Movers& at, std::size_t p) __attribute__((always_inline)) {
        const FewLanes push = kick / load<FewLanes>(at.mass + p);
        FewLanes speed{};
        for (int i = 0; i < 3; ++i) {
            const FewLanes v =
                load<FewLanes>(at.v[i] + p) + (push * load<FewLanes>(at.f[i] + p) + kick * fall[i]);
            const FewLanes x = load<FewLanes>(at.x[i] + p) + step * v;
            store(v, at.v[i] + p);
            store(x, at.x[i] + p);
            speed += v * v;
            wrong += x - x;
        }
        fastest = larger(fastest, speed);
        wrong += speed - speed;
    };
    for (; begin + kFewLanes <= end; begin += kFewLanes) batch(m, begin);
    if (begin < end) {
        double copy[10][kFewLanes];
        Movers last;
        const std::size_t count = end - begin;
        const auto take = [&](int n, const double* from, double fill) {
            std::fill_n(copy[n], kFewLanes, fill);
            std::copy_n(from + begin, count, copy[n]);
            return copy[n];
        };
        for (int i = 0; i < 3; ++i) {
            last.x[i] = take(i, m.x[i], 0), last.v[i] = take(3 + i, m.v[i], 0);
            last.f[i] = take(6 + i, m.f[i], 0);
        }
        last.mass = take(9, m.mass, 1);
        batch(last, 0);
        for (int i = 0; i < 3; ++i) {
            std::copy_n(copy[i], count, m.x[i] + begin);
            std::copy_n(copy[3 + i], count, m.v[i] + begin);
        }
    }
    double most = 0, sum = 0;
    for (int l = 0; l < kFewLanes; ++l) most = std::max(most, fastest[l]), sum += wrong[l];
    return sum == 0 ? most : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double explicit_step(const Aggregate& matter, const SimSettings& settings, bool is_cut) {
    const LatticeForces lattice(matter);
    const SwingBound swings(matter, matter.breaks() || is_cut);
    return stable_step(matter, settings.step_safety, lattice, swings,
                       InternalDamping(matter, std::sqrt(swings.squared(matter, lattice))));
}

MovingBody::MovingBody(Aggregate& matter, int number, const Apparatus& apparatus,
                       const SimSettings& settings)
    : matter_(matter),
      lattice_(matter, Excess::lives_on),
      breaks_(matter.breaks()),
      swings_(matter, breaks_ || !apparatus.blade.empty()),
      damping_(matter, std::sqrt(swings_.squared(matter, lattice_))),
      contacts_(matter, apparatus, settings, number),
      pushes_(apparatus, settings, number),
      safety_(settings.step_safety),
      step_(swage::stable_step(matter, safety_, lattice_, swings_, damping_)),
      present_step_(step_),
      drag_(matter, settings, step_),
      load_(apparatus.tool.size() + apparatus.grip.size()),
      touches_(!apparatus.tool.empty()),
      remembers_(breaks_ || matter.yields() || !matter.mixed_cell.empty()),
      implicit_(settings.solver == Solver::implicit_steps),
      saves_branches_(settings.solver == Solver::energy_stepped),
      flies_(only_gravity_acts(apparatus, settings)) {
    for (std::size_t n = 0; n < matter.material_count(); ++n) {
        stiffens_ = stiffens_ || elasticity_of(matter, n) == Elasticity::storakers;
    }
    if (implicit_) let_go();
}

double MovingBody::branch_energy() {
    if (!damping_.acts()) return 0;
    if (branch_energy_ < 0) branch_energy_ = damping_.stored_energy(matter_, lattice_);
    return branch_energy_;
}

double MovingBody::elastic_energy() { return lattice_.elastic_energy(matter_) + branch_energy(); }

void MovingBody::start(const Drive& from, BodyOutcome& outcome) {
    pushes_.start(matter_, from);
    find_candidates(from);
    begin_step(from);
    find_forces(from, 0, outcome);
    load_ = implicit_ ? contacts_.at_rest().loads(matter_, from) : contacts_.loads();
}

void MovingBody::begin_step(const Drive& before) {
    if (implicit_) {
        contacts_.begin_implicit_step(matter_, before);
    } else {
        contacts_.begin_step(before);
    }
}

void MovingBody::find_candidates(const Drive& now) {
    contacts_.find_candidates(matter_, now);
    gone_ = 0;
}

double MovingBody::surface_changed(const Drive& now) {
    pushes_.connections_changed(matter_);
    drag_.connections_changed(matter_);
    const RestingContacts& at_rest = contacts_.at_rest();
    double held = implicit_ ? at_rest.stored_energy(matter_, now) : 0;
    const double let_go = contacts_.connections_changed(matter_, now);
    held = implicit_ ? held - at_rest.stored_energy(matter_, now) : let_go;
    if (touches_) gone_ = std::numeric_limits<double>::infinity();
    return held;
}

void MovingBody::masses_changed(const std::vector<double>& was) {
    pushes_.masses_changed(matter_, was);
    contacts_.masses_changed();
    swings_.masses_changed(matter_);
    step_ = std::min(step_, swage::stable_step(matter_, safety_, lattice_, swings_, damping_));
    flowed_ = true;  // the present one is to be found anew
    drag_.find_limits(matter_, step_);
}

void MovingBody::renew_candidates(const Drive& before, const Drive& now, double way) {
    if (!touches_) return;
    const double far = 0.45 * matter_.lattice.spacing;
    gone_ += way + contacts_.travel(matter_, before, now);
    if (gone_ > far) find_candidates(now);
}

double MovingBody::move(double kick, double step) {
    in_time_ = false;
    Vec3Array &x = matter_.particle_position, &v = matter_.particle_velocity;
    const Vec3Array& f = force_;
    const Movers movers{{x.x.data(), x.y.data(), x.z.data()},
                        {v.x.data(), v.y.data(), v.z.data()},
                        {f.x.data(), f.y.data(), f.z.data()},
                        matter_.particle_mass.data()};
    const double fall[3] = {gravity_.x(), gravity_.y(), gravity_.z()};
    const auto move_chunk = [&](std::size_t begin, std::size_t end) {
        return move_block(movers, begin, end, kick, step, fall);
    };
    double most = 0;
    for (double one : of_each_chunk(x.size(), move_chunk))
        most = std::isnan(one) || std::isnan(most) ? kLost : std::max(one, most);
    return step * std::sqrt(most);
}

std::optional<Vec3> MovingBody::flight_velocity() {
    if (!flies_ || inside_out_ > 0 || contacts_.has_thin()) return std::nullopt;
    for (const PartSum& tool : load_) {
        if (tool.contacts > 0) return std::nullopt;  // it may stick to what it does not press on
    }
    const std::optional<Vec3> velocity = swage::flight_velocity(matter_, step_);
    if (!velocity || holds_strain(matter_, elastic_energy(), step_)) return std::nullopt;
    return velocity;
}

void MovingBody::fly(const Drive& before, const Drive& now, const Vec3& velocity,
                     BodyOutcome& outcome) {
    const double time = now.time - before.time;
    const Vec3 faster = time * gravity_, way = time * (velocity + 0.5 * faster);
    const auto add = [](const Vec3& more, Vec3Array& to) {
        for (std::size_t p = 0; p < to.size(); ++p) to.add(p, more);
    };
    add(faster, matter_.particle_velocity);
    add(way, matter_.particle_position);
    find_candidates(now);
    begin_step(now);
    find_forces(now, 0, outcome);
    contacts_.commit(now);
    pushes_.commit(matter_, now, outcome.load_work);
}

void MovingBody::let_go() {
    damping_.let_go(matter_);
    branch_energy_ = -1;
}

void MovingBody::set_implicit(bool implicit) {
    implicit_ = implicit;
    if (implicit) let_go();
}

// Of the lattice and its damping.
void MovingBody::find_inner_forces(double step, BodyOutcome& outcome) {
    if (!damping_.acts() || implicit_) {
        inside_out_ = lattice_.find(matter_, Flow::trial, force_);
        return;
    }
    branch_energy_ = -1;
    const std::vector<BranchStep> branches = damping_.step(matter_, lattice_, step);
    inside_out_ = lattice_.find(matter_, Flow::trial, force_, branches, &outcome.damped_work);
}

void MovingBody::find_forces(const Drive& now, double step, BodyOutcome& outcome) {
    find_inner_forces(step, outcome);
    if (drag_.acts()) {
        // Forces do half of their work on the way to where they were found.
        const double before = step > 0 ? drag_.power(matter_) : 0;
        const SurfaceDrag::Drag drag = drag_.add_forces(matter_, force_);
        outcome.drag_work += 0.5 * step * (before + drag.power);
        outcome.drag_bounded = outcome.drag_bounded || drag.bounded;
    }
    pushes_.add_forces(matter_, now, force_);
    gravity_ = pushes_.gravity(now);
    // Last: dashpots go by the speed that all else makes.
    if (implicit_) {
        contacts_.at_rest().add_forces(matter_, now, force_);
    } else {
        contacts_.add_forces(matter_, now, step, gravity_, force_);
    }
}

// What flows, softens, cracks and snaps at the present positions, whose forces were just found.
bool MovingBody::remember(const Drive& now, double step, BodyOutcome& outcome) {
    if (!remembers_) return false;
    branch_energy_ = -1;  // branches soften too
    int broken = 0;
    const auto book = [&](const Committed& lost) {
        outcome.plastic_work += lost.plastic;
        flowed_ = flowed_ || lost.plastic != 0;
        outcome.fracture_work += lost.fracture;
        outcome.broken += lost.broken;
        broken += lost.broken;
    };
    const bool damped = damping_.acts() && !implicit_;
    book(lattice_.commit(matter_, Forces::fresh, damped ? damping_.growths() : nullptr));
    const Cracked cracked = lattice_.crack(matter_, Forces::fresh);
    outcome.fracture_work += cracked.lost;
    if (lattice_.may_snap()) {
        turned_ += step * top_speed();
        if (turned_ > kTurned * matter_.lattice.spacing) {
            turned_ = 0;
            book(lattice_.snap(matter_));
        }
    }
    if (broken > 0) outcome.damped_work += surface_changed(now);
    return broken > 0 || cracked.cells > 0;
}

void MovingBody::finish_step(const Drive& before, const Drive& now, double step,
                             BodyOutcome& outcome) {
    if (remembers_) lattice_.book_flow(matter_, step);
    if (lattice_.saw_crushed() || inside_out_ > 0) {
        outcome.damped_work += calm_crushed(matter_, portable::exp(-kCalm * step / step_));
    }
    loss_to_book_ = 0;
    if (remember(now, step, outcome)) {
        find_forces(now, 0, outcome);
        loss_to_book_ = lattice_.trial_loss();
    }
    if (implicit_) {
        outcome.friction_work += contacts_.commit_implicit_step(matter_, now);
    } else {
        const ToolLosses taken = contacts_.commit(now);
        outcome.damped_work += taken.damped;
        outcome.friction_work += taken.friction;
    }
    std::vector<PartSum> load =
        implicit_ ? contacts_.at_rest().loads(matter_, now) : contacts_.loads();
    add_work(before, now, load_, load, outcome.work);
    for (std::size_t n = 0; n < load.size(); ++n) outcome.touched[n] |= load[n].contacts > 0;
    pushes_.commit(matter_, now, outcome.load_work);
    load_ = std::move(load);
}

bool MovingBody::is_stirred(const Drive& since, const Drive& now) const {
    const double travel = contacts_.near_travel(since, now);
    return travel > kStirred * matter_.lattice.spacing || pushes_.is_stirred(since, now);
}

double MovingBody::push_change(const Drive& from, const Drive& to) const {
    if (!pushes_.is_stirred(from, to)) return 0;
    const std::size_t count = matter_.particle_count();
    Vec3Array before, after;
    set_zero(count, before);
    set_zero(count, after);
    pushes_.add_forces(matter_, from, before);
    pushes_.add_forces(matter_, to, after);
    const Vec3 fall = pushes_.gravity(to) - pushes_.gravity(from);
    double most = 0;
    for (std::size_t p = 0; p < count; ++p) {
        const Vec3 push = after.at(p) - before.at(p);
        most = std::max(most, (push / matter_.particle_mass[p] + fall).squaredNorm());
    }
    return std::sqrt(most);
}

void MovingBody::stop() { set_zero(matter_.particle_count(), matter_.particle_velocity); }

double MovingBody::kinetic_energy(double step) const {
    const Vec3Array& v = matter_.particle_velocity;
    const double half = 0.5 * step;
    return chunked_sum(v.size(), [&](std::size_t p) {
        return 0.5 * matter_.particle_mass[p] *
               (v.at(p).squaredNorm() - (half * acceleration(p)).squaredNorm());
    });
}

Stored MovingBody::stored(const Drive& now, double step) {
    Stored all;
    all.elastic = elastic_energy();
    all.contact =
        implicit_ ? contacts_.at_rest().stored_energy(matter_, now) : contacts_.stored_energy();
    all.kinetic = kinetic_energy(step);
    return all;
}

std::vector<double> MovingBody::stiffness_bound() const {
    std::vector<double> bound = lattice_.stiffness_bound(matter_);
    contacts_.at_rest().add_stiffness(matter_, bound);
    return bound;
}

double MovingBody::round_off(double step) const {
    const Vec3Array& x = matter_.particle_position;
    const Vec3 gravity = this->gravity().cwiseAbs();
    const double eps = std::numeric_limits<double>::epsilon();
    const double pushed = chunked_sum(x.size(), [&](std::size_t p) {
        const Vec3 far = eps * x.at(p).cwiseAbs();
        return (force_.at(p).cwiseAbs() + matter_.particle_mass[p] * gravity).dot(far);
    });
    return pushed + rounding_energy(matter_, step) + elastic_rounding(matter_);
}

double MovingBody::top_speed() const {
    const Vec3Array& v = matter_.particle_velocity;
    const auto of_chunk = [&](std::size_t begin, std::size_t end) {
        double most = 0;
        for (std::size_t p = begin; p < end; ++p) most = std::max(most, v.at(p).squaredNorm());
        return most;
    };
    double most = 0;
    for (double one : of_each_chunk(v.size(), of_chunk)) most = std::max(most, one);
    return std::sqrt(most);
}

double MovingBody::present_step() {
    if (flowed_) {
        present_step_ =
            std::min(step_, swage::stable_step(matter_, safety_, lattice_, swings_, damping_));
        flowed_ = false;
    }
    if (inside_out_ == 0 && !stiffens_) return present_step_;
    std::vector<double> guard(matter_.particle_count(), 0.0);
    add_guard_stiffness(matter_, guard);
    return 1 /
           std::sqrt(1 / (present_step_ * present_step_) + 0.25 * most_per_mass(guard, matter_));
}

void MovingBody::save(State& state) const {
    state.matter.save(matter_);
    state.contacts = contacts_;
    state.pushes = pushes_;
    if (saves_branches_) {
        state.damping = damping_;
        state.memory = matter_.branch_memory;
    }
    state.drag = drag_.given();
    state.load = load_;
    state.gone = gone_;
    state.turned = turned_;
    state.loss_to_book = loss_to_book_;
}

void MovingBody::restore(const State& state, BodyOutcome& outcome) {
    state.matter.restore(matter_);
    if (remembers_) {
        flowed_ = true;
        lattice_.take_in(matter_);
    }
    contacts_ = *state.contacts;
    pushes_ = *state.pushes;
    if (breaks_) drag_.connections_changed(matter_);
    if (saves_branches_) {
        damping_ = *state.damping;
        matter_.branch_memory = state.memory;
        branch_energy_ = -1;
    } else {
        let_go();
        outcome.damped_work += block_energy_;
    }
    drag_.put_back(state.drag);
    load_ = state.load;
    turned_ = state.turned;
    loss_to_book_ = state.loss_to_book;
    gone_ = state.gone;  // as long ago as the candidates that it goes back to
}

}  // namespace swage
