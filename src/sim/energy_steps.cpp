// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/energy_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"
#include "geometry/box.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr double kTolerance = 1e-9;  // of all energy that was put in, that a step may gain
constexpr double kMistake = 1e-6;    // likewise, that it may lose where no book says so
constexpr double kFinest = 1e-6;     // of the stable step; shorter ones may lose more
constexpr double kWay = 0.3;         // spacings that the fastest particle, or tool, goes in a step
constexpr double kDriven = 0.5;      // stable steps, while what acts on a body changes
constexpr double kShortest = 1e-9;   // of the stable step of explicit steps

double acceleration_of(const MovingBody& body) {
    double most = 0;
    for (std::size_t p = 0; p < body.matter().particle_count(); ++p) {
        most = std::max(most, body.acceleration(p).squaredNorm());
    }
    return std::sqrt(most);
}

// How far any of its particles may get while the drive does this, if no other body strikes it: what
// a tool or a grip strikes leaves it twice as fast.
double reach_of(const MovingBody& body, const Drive& from, const Drive& to) {
    const double time = to.time - from.time;
    return body.matter().lattice.spacing + 1.5 * time * body.top_speed() +
           time * time * (acceleration_of(body) + body.push_change(from, to)) +
           2 * body.drive_travel(from, to);
}

// What it may come to hold while the drive does this, beginning with so much, by itself [J].
double energy_of(const MovingBody& body, double held, const Drive& from, const Drive& to) {
    const Aggregate& matter = body.matter();
    const double time = to.time - from.time, mass = matter.mass();
    Vec3 pushed = Vec3::Zero();
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        pushed += matter.particle_mass[p] * body.acceleration(p);
    }
    const double faster = time * (pushed.norm() / mass + body.push_change(from, to)) +
                          2 * body.drive_travel(from, to) / time;
    const double speed = std::sqrt(2 * std::max(held, 0.0) / mass) + faster;
    return 0.5 * mass * speed * speed;
}

Vec3Array mean_speed(const Vec3Array& from, const Vec3Array& to, double step) {
    Vec3Array speed;
    speed.resize(from.size());
    for (std::size_t p = 0; p < from.size(); ++p) speed.set(p, (to.at(p) - from.at(p)) / step);
    return speed;
}

// Whether they may meet when each has gone so far.
bool may_meet(const Box& a, double far_a, const Box& b, double far_b) {
    const double far = far_a + far_b;
    return (a.low.array() - far <= b.high.array()).all() &&
           (b.low.array() - far <= a.high.array()).all();
}

}  // namespace

void carry_on(MovingBody& body, double step, double last, Vec3Array& before) {
    Aggregate& matter = body.matter();
    Vec3Array &x = matter.particle_position, &v = matter.particle_velocity;
    const bool carried = before.size() == x.size();
    const double r = carried ? step / last : 0;
    before.resize(x.size());
    for_each_chunk(x.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            const Vec3 a = body.acceleration(p);
            const Vec3 rise = carried ? Vec3(r * (a - before.at(p))) : Vec3(Vec3::Zero());
            x.add(p, step * v.at(p) + step * step / 2 * (a + rise / 3));
            v.add(p, step * (a + rise / 2));
            before.set(p, a);
        }
    });
}

void find_forces_of_step(MovingBody& body, const Drive& now, const Vec3Array& from, double step,
                         BodyOutcome& outcome) {
    Vec3Array speed = mean_speed(from, body.matter().particle_position, step);
    std::swap(speed, body.matter().particle_velocity);
    body.find_forces(now, step, outcome);
    std::swap(speed, body.matter().particle_velocity);
}

EnergySteps::EnergySteps(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                         const SimSettings& settings)
    : apparatus_(apparatus), contact_(bodies, settings), by_contact_(bodies.size()) {
    mover_.reserve(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        mover_.push_back({MovingBody(*bodies[b], static_cast<int>(b), apparatus, settings)});
    }
}

double EnergySteps::connections_changed(std::size_t body, const Drive& now) {
    const double let_go = mover_[body].body.connections_changed(now);
    contact_.connections_changed(body);
    return let_go;
}

// What springs of contacts hold of each body now [J]. Nothing is changed by it.
std::vector<double> EnergySteps::held_by_contacts() {
    std::vector<double> held(mover_.size(), 0.0);
    if (!contact_.acts()) return held;
    const std::vector<char> awake(mover_.size(), 0);
    std::vector<Vec3Array> unused;
    for (Mover& m : mover_) unused.push_back(m.body.force());
    std::vector<Vec3Array*> force;
    for (Vec3Array& one : unused) force.push_back(&one);
    std::vector<ContactSums> sums;
    const std::shared_ptr<const BodyContact::State> state = contact_.save();
    contact_.renew_all(awake);
    contact_.add_forces(force, mover_[0].body.gravity(), 0, awake, sums, Meet::as_kept);
    contact_.restore(*state);
    for (std::size_t b = 0; b < held.size(); ++b) held[b] = sums[b].stored;
    return held;
}

// Bodies whose boxes may meet within the frame, in the order of their first. Whatever strikes what
// in a group, none of it goes faster than with all of the group's energy: a light body leaves a
// heavy one up to twice as fast as that came, and may so throw another, lighter one.
std::vector<EnergySteps::Group> EnergySteps::groups(const Drive& from, const Drive& to) {
    const double time = to.time - from.time;
    std::vector<Box> box(mover_.size());
    std::vector<double> far, energy = held_by_contacts();  // energy: of the group that begins so
    std::vector<std::size_t> first(mover_.size());
    for (std::size_t b = 0; b < first.size(); ++b) {
        MovingBody& body = mover_[b].body;
        box[b] = box_of(body.matter().particle_position);
        far.push_back(reach_of(body, from, to));
        energy[b] = energy_of(body, body.stored(from, 0).sum() + energy[b], from, to);
        first[b] = b;
    }
    const auto all_go_farther = [&](std::size_t group) {
        for (std::size_t b = 0; b < first.size(); ++b) {
            if (first[b] != group) continue;
            const Aggregate& matter = mover_[b].body.matter();
            const double way = time * std::sqrt(2 * energy[group] / matter.mass());
            // About its centre a corner may be twice as fast, but goes no farther than across.
            const double turns = std::min(2 * way, box[b].size().norm());
            far[b] = std::max(far[b], matter.lattice.spacing + way + turns);
        }
    };
    const auto unite_some = [&] {
        bool any = false;
        for (std::size_t a = 0; a < first.size(); ++a) {
            for (std::size_t b = a + 1; b < first.size(); ++b) {
                const std::size_t low = std::min(first[a], first[b]),
                                  high = std::max(first[a], first[b]);
                if (low == high || !may_meet(box[a], far[a], box[b], far[b])) continue;
                energy[low] += energy[high];
                for (std::size_t& f : first) f = f == high ? low : f;
                all_go_farther(low);
                any = true;
            }
        }
        return any;
    };
    while (unite_some()) {
    }
    std::vector<Group> found;
    for (std::size_t b = 0; b < first.size(); ++b) {
        if (first[b] != b) continue;
        found.emplace_back();
        for (std::size_t c = b; c < first.size(); ++c) {
            if (first[c] == b) found.back().push_back(c);
        }
    }
    return found;
}

double EnergySteps::step_to_try(const Group& group, const Drive& begin, const Drive& to) const {
    const double left = to.time - begin.time;
    double step = left;
    for (std::size_t b : group) {
        const Mover& m = mover_[b];
        const double stable = m.body.stable_step();
        step = std::min(step, m.step > 0 ? m.step : stable);
        if (m.body.is_stirred(begin, to)) step = std::min(step, kDriven * stable);
        // v t + a t^2 <= far
        const double far = kWay * m.body.matter().lattice.spacing, v = m.body.top_speed(),
                     a = acceleration_of(m.body), travel = m.body.drive_travel(begin, to);
        const double root = v + std::sqrt(v * v + 4 * a * far);
        if (root > 0) step = std::min(step, 2 * far / root);
        if (travel > far) step = std::min(step, left * far / travel);
    }
    return left / std::max(1.0, std::ceil(left / step * (1 - 1e-9)));
}

std::vector<char> EnergySteps::all_but(const Group& group) const {
    std::vector<char> others(mover_.size(), 1);
    for (std::size_t b : group) others[b] = 0;
    return others;
}

// Adds the forces of contact within the group, where nothing else has moved since the group began.
void EnergySteps::meet(const Group& group, double step, Meet how) {
    if (!contact_.acts()) return;
    std::vector<Vec3Array*> force;
    for (Mover& m : mover_) force.push_back(&m.body.force());
    contact_.renew(all_but(group));
    contact_.add_forces(force, mover_[group[0]].body.gravity(), step, all_but(group), by_contact_,
                        how);
}

std::vector<Stored> EnergySteps::stored(const Group& group, const Drive& now) {
    std::vector<Stored> store;
    for (std::size_t b : group) {
        store.push_back(mover_[b].body.stored(now, 0));
        store.back().contact += by_contact_[b].stored;
    }
    return store;
}

// A step of a group, and what is needed to take it back.
struct EnergySteps::Try {
    Drive begin, now;
    double step;
    std::vector<Stored> after{};        // by place in the group
    std::vector<BodyOutcome> so_far{};  // before it
    std::vector<double> to_book{};      // MovingBody::loss_to_book()
    std::vector<Vec3Array> earlier{};   // Mover::before
    std::vector<Vec3Array> force{};     // there, and gravity [m/s2]
    std::vector<Vec3> gravity{};
    std::shared_ptr<const BodyContact::State> contact{};
    double done = 0, turned = 0;  // work in it, and that with every sign made positive [J]
    double gain = 0, astray = 0;  // energy less work, and less what the books say is lost [J]
};

EnergySteps::Try EnergySteps::take(const Group& group, const Drive& begin, const Drive& now,
                                   double step, const std::vector<Stored>& store,
                                   MoveOutcome& outcome) {
    Try t{begin, now, step};
    if (contact_.acts()) t.contact = contact_.save();
    std::vector<Vec3Array> speed;
    for (std::size_t b : group) {
        Mover& m = mover_[b];
        t.so_far.push_back(outcome.body[b]);
        t.to_book.push_back(m.body.loss_to_book());
        t.earlier.push_back(m.before);
        t.force.push_back(m.body.force());
        t.gravity.push_back(m.body.gravity());
        m.body.save(m.state);
        m.body.begin_step(begin);
        m.body.begin_block(outcome.body[b]);
        const Vec3Array was = m.body.matter().particle_position;
        carry_on(m.body, t.step, m.last_step, m.before);
        find_forces_of_step(m.body, now, was, t.step, outcome.body[b]);
        m.body.finish_step(begin, now, t.step, outcome.body[b]);
        if (outcome.body[b].broken > t.so_far.back().broken) contact_.connections_changed(b);
        m.body.end_block(outcome.body[b]);
        m.body.renew_candidates(
            begin, now, std::sqrt(3.0) * farthest_move(was, m.body.matter().particle_position));
        speed.push_back(mean_speed(was, m.body.matter().particle_position, t.step));
    }
    if (contact_.acts()) {
        const auto swap_speeds = [&] {
            for (std::size_t n = 0; n < group.size(); ++n) {
                std::swap(speed[n], mover_[group[n]].body.matter().particle_velocity);
            }
        };
        swap_speeds();
        meet(group, t.step, Meet::anew);
        swap_speeds();
        for (std::size_t b : group) outcome.body[b].by_contact.add(by_contact_[b], t.step);
        contact_.commit(all_but(group));
    }
    t.after = stored(group, now);
    for (std::size_t n = 0; n < group.size(); ++n) {
        const BodyOutcome &is = outcome.body[group[n]], &was = t.so_far[n];
        t.done += is.done() - was.done();
        t.turned += std::abs(is.done() - was.done());
        t.gain += t.after[n].sum() - store[n].sum();
        // NOTE: without it no step in which a cell cracks closed its books, however short.
        const double booked_late = mover_[group[n]].body.loss_to_book() - t.to_book[n];
        t.astray += is.lost_since(was, booked_late);
    }
    t.gain -= t.done;
    t.astray += t.gain;
    return t;
}

// Whether the books of a step hold against `budget`, all that was ever put in [J].
bool EnergySteps::holds(const Group& group, const Try& t, double budget) {
    double noise = 0;
    const auto within = [&](double error, double share) {
        if (error <= share * budget) return true;
        if (noise == 0) {
            for (std::size_t b : group) noise += mover_[b].body.round_off(t.step);
        }
        return error <= share * budget + noise;
    };
    const bool finest = t.step < kFinest * stable_step(group);
    return within(t.gain, kTolerance) && (within(std::abs(t.astray), kMistake) || finest);
}

void EnergySteps::keep(const Group& group, const Try& t, MoveOutcome& outcome) {
    for (std::size_t n = 0; n < group.size(); ++n) {
        Mover& m = mover_[group[n]];
        m.budget += std::abs(outcome.body[group[n]].done() - t.so_far[n].done());
        m.last_step = t.step;
        m.step = m.was_taken_back ? t.step : 1.5 * t.step;
        m.was_taken_back = false;
    }
    ++outcome.steps;
    ++steps_;
    outcome.shortest_step = std::min(outcome.shortest_step, t.step);
}

std::string EnergySteps::take_back(const Group& group, Try& t, double budget,
                                   MoveOutcome& outcome) {
    ++outcome.rejected;
    ++outcome.halvings;
    std::string why;
    if (!(t.step > kShortest * stable_step(group))) {
        const Finding found{.fault = std::isfinite(t.gain) ? Fault::gains : Fault::lost,
                            .body = group[0],
                            .step = steps_ + 1,
                            .time = t.now.time,
                            .gain = t.gain / budget};
        why = sentence_of(found, mover_[group[0]].body, apparatus_.name, t.step,
                          Solver::energy_stepped);
    }
    for (std::size_t n = 0; n < group.size(); ++n) {
        Mover& m = mover_[group[n]];
        const bool broke = outcome.body[group[n]].broken > t.so_far[n].broken;
        outcome.body[group[n]] = t.so_far[n];
        m.before = std::move(t.earlier[n]);
        m.body.restore(m.state, outcome.body[group[n]]);
        if (broke) contact_.connections_changed(group[n]);  // which are whole again
        m.body.restore_forces(std::move(t.force[n]), t.gravity[n]);
        m.step = 0.5 * t.step;
        m.was_taken_back = true;
    }
    if (t.contact) contact_.restore(*t.contact);
    return why;
}

double EnergySteps::stable_step(const Group& group) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t b : group) shortest = std::min(shortest, mover_[b].body.stable_step());
    return shortest;
}

// All that a frame began with, to be gone back to once.
struct EnergySteps::Begun {
    std::vector<MovingBody::State> body{};
    std::vector<BodyOutcome> outcome{};
    std::vector<Vec3Array> force{};
    std::vector<Vec3> gravity{};
    std::shared_ptr<const BodyContact::State> contact{};
    std::vector<ContactSums> by_contact{};
};

EnergySteps::Begun EnergySteps::begun(const MoveOutcome& outcome) {
    Begun all;
    all.body.resize(mover_.size());
    all.outcome = outcome.body;
    for (std::size_t b = 0; b < mover_.size(); ++b) {
        mover_[b].body.save(all.body[b]);
        all.force.push_back(mover_[b].body.force());
        all.gravity.push_back(mover_[b].body.gravity());
    }
    if (contact_.acts()) all.contact = contact_.save();
    all.by_contact = by_contact_;
    return all;
}

void EnergySteps::put_back(Begun& begun, const Drive& from, MoveOutcome& outcome) {
    for (std::size_t b = 0; b < mover_.size(); ++b) {
        const bool broke = outcome.body[b].broken > begun.outcome[b].broken;
        outcome.body[b] = begun.outcome[b];
        mover_[b].body.restore(begun.body[b], outcome.body[b]);
        if (broke) contact_.connections_changed(b);
        mover_[b].body.restore_forces(std::move(begun.force[b]), begun.gravity[b]);
    }
    if (begun.contact) contact_.restore(*begun.contact);
    by_contact_ = begun.by_contact;
    for (std::size_t b = 0; b < mover_.size(); ++b) {
        outcome.body[b].before = outcome.body[b].after = stored({b}, from)[0];
    }
    outcome.rejected += std::exchange(outcome.steps, 0);
}

std::optional<MoveEnd> EnergySteps::advance(const Group& group, const Drive& from, const Drive& to,
                                            MoveOutcome& outcome) {
    std::optional<MoveEnd> given_up;
    contact_.renew_all(all_but(group));
    meet(group, mover_[group[0]].last_step > 0 ? mover_[group[0]].last_step : stable_step(group),
         Meet::as_kept);
    std::vector<Stored> store = stored(group, from);
    for (std::size_t n = 0; n < group.size(); ++n) {
        const std::size_t b = group[n];
        outcome.body[b].by_contact.start(by_contact_[b]);
        outcome.body[b].before = store[n];
        outcome.body[b].before.contact += by_contact_[b].damped;  // let go of as it began
        if (mover_[b].step == 0) mover_[b].budget = std::max(store[n].sum(), 0.0);
    }
    for (Drive begin = from; begin.time < to.time && !given_up;) {
        throw_if_interrupted();
        const double left = to.time - begin.time, step = step_to_try(group, begin, to);
        const double end = begin.time + step;
        const Drive now = step >= left || end >= to.time
                              ? to
                              : drive_between(from, to, (end - from.time) / (to.time - from.time));
        Try t = take(group, begin, now, step, store, outcome);
        double budget = t.turned;
        for (std::size_t b : group) budget += mover_[b].budget;
        const bool good = holds(group, t, budget);
        if (tried_ != nullptr) tried_->push_back({begin.time, t.step, t.astray, good});
        if (!good) {
            const std::string why = take_back(group, t, budget, outcome);
            if (!why.empty()) given_up = {Error(ExitCode::stopped, why), begin};
            continue;
        }
        keep(group, t, outcome);
        store = std::move(t.after);
        begin = now;
    }
    for (std::size_t n = 0; n < group.size(); ++n) outcome.body[group[n]].after = store[n];
    return given_up;
}

MoveOutcome EnergySteps::advance(const Drive& from, const Drive& to) {
    MoveOutcome outcome;
    outcome.body.assign(mover_.size(), BodyOutcome(apparatus_, pushes(0).count()));
    outcome.shortest_step = to.time - from.time;
    for (std::size_t b = 0; b < mover_.size(); ++b) mover_[b].body.start(from, outcome.body[b]);
    const std::vector<Group> apart = groups(from, to);
    std::optional<Begun> all;
    if (apart.size() > 1) all = begun(outcome);
    for (const Group& group : apart) {
        outcome.given_up = advance(group, from, to, outcome);
        if (!outcome.given_up) continue;
        if (all) {  // the others have got to other times
            put_back(*all, from, outcome);
            outcome.given_up->at = from;
        }
        break;
    }
    for (std::size_t b = 0; b < mover_.size(); ++b) outcome.body[b].part = mover_[b].body.load();
    return outcome;
}

}  // namespace swage
