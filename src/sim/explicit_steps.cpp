// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/explicit_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr long kBlock = 64;           // steps
constexpr double kWayAhead = 0.3;     // spacings a step that the fastest particle is given
constexpr int kPatience = 8;          // blocks until a halved step is doubled again
constexpr double kFrameShare = 0.25;  // of a frame, in an implicit step
constexpr double kRescueStep = 64;    // explicit steps in an implicit one that stands in for them
constexpr int kRescueHalvings = 10;
constexpr long kRescue = 4;  // blocks of these

// Of a body in a step.
struct Moved {
    double way = 0;  // the longest of any particle [m]
    Finding found;
    bool broke = false;
};

// What was done, whether for or against.
double turned_over(const std::vector<double>& before, const std::vector<double>& after) {
    double sum = 0;
    for (std::size_t n = 0; n < after.size(); ++n) sum += std::abs(after[n] - before[n]);
    return sum;
}

// Dashpots stand along the connections: of what resists a change of volume beyond these
// (nu > 1/4), whose swings are the fastest, nothing is damped.
double damped_share(const Aggregate& matter, const Material& material) {
    if (matter.material.mechanics == Mechanics::springs) return 1;
    return std::min(1.0, 2 * (1 - 2 * material.poisson_ratio));
}

double euler_step(const Aggregate& matter, const MovingBody& body) {
    double least = 1;
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        const Material& material = matter.material_at(m);
        least = std::min(least, material.damping_ratio * damped_share(matter, material));
    }
    const double zeta = largest_damping_ratio(matter);
    return body.stable_step() * least / (std::sqrt(1 + zeta * zeta) - zeta);
}

bool meets(Solver solver) { return solver == Solver::explicit_steps || solver == Solver::euler; }

}  // namespace

ExplicitSolver::ExplicitSolver(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                               const SimSettings& settings)
    : apparatus_(apparatus),
      settings_(settings),
      state_(bodies.size()),
      contact_(meets(settings.solver) ? bodies : std::vector<Aggregate*>{}, settings),
      sleeping_(bodies, settings),
      asleep_since_(bodies.size()),
      held_(bodies.size()),
      step_(std::numeric_limits<double>::infinity()),
      inside_out_(bodies.size(), 0),
      implicit_(bodies.size()) {
    body_.reserve(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        body_.emplace_back(*bodies[b], static_cast<int>(b), apparatus, settings);
        step_ = std::min(step_, settings.solver == Solver::euler ? euler_step(*bodies[b], body_[b])
                                                                 : body_[b].stable_step());
    }
    if (settings.solver == Solver::implicit_steps) return;
    for (MovingBody& body : body_) body.limit_stiffness(step_);
    contact_.limit_stiffness(step_);
}

void ExplicitSolver::connections_changed(std::size_t body) {
    body_[body].connections_changed();  // fewer are never faster, so the step stays
    implicit_[body] = {};
    contact_.connections_changed(body);
    sleeping_.wake(body);
}

void ExplicitSolver::meet(const Drive& now, double dt, bool again, MoveOutcome& outcome) {
    if (!contact_.acts()) return;
    contact_.renew(sleeping_.asleep());
    if (sleeping_.any()) wake_neighbours(now, outcome);
    std::vector<Vec3Array*> force;
    for (MovingBody& body : body_) force.push_back(&body.force());
    contact_.add_forces(force, body_[0].gravity(), dt, sleeping_.asleep(), met_, again);
}

// What sleeps near a body that is awake.
void ExplicitSolver::wake_neighbours(const Drive& now, MoveOutcome& outcome) {
    const std::vector<std::size_t> group = contact_.groups();
    std::vector<char> awake(group.size(), 0);
    for_each_awake([&](std::size_t b) { awake[group[b]] = 1; });
    for (std::size_t b = 0; b < body_.size(); ++b) {
        if (!sleeping_.is_asleep(b) || !awake[group[b]]) continue;
        wake(b, outcome);
        body_[b].begin_step(now);
        body_[b].find_forces(now, 0, outcome.body[b]);
    }
}

void ExplicitSolver::wake(std::size_t b, MoveOutcome& outcome) {
    sleeping_.wake(b);
    if (!in_block_) return;
    save(b);  // it lies as it did when the block began
    body_[b].begin_block(outcome.body[b]);
}

// What something has come to move since it fell asleep.
void ExplicitSolver::wake_stirred(const Drive& before, const Drive& now, double dt,
                                  MoveOutcome& outcome) {
    bool any = false;
    for (std::size_t b = 0; b < body_.size(); ++b) {
        if (!sleeping_.is_asleep(b)) continue;
        body_[b].renew_candidates(before, now, 0);
        if (!body_[b].is_stirred(asleep_since_[b], now)) continue;
        wake(b, outcome);
        any = true;
    }
    if (!any) return;
    for_each_awake([&](std::size_t b) {
        body_[b].begin_step(before);
        body_[b].find_forces(before, 0, outcome.body[b]);
    });
    meet(before, dt, true, outcome);
}

// Bodies that lie still, as far as all that are near them do.
void ExplicitSolver::put_to_sleep(const Drive& now, MoveOutcome& outcome) {
    std::vector<char> rests(body_.size(), 1);
    for_each_awake([&](std::size_t b) {
        rests[b] = sleeping_.rests(b, now.time, outcome.body[b].after.kinetic);
    });
    std::vector<std::size_t> group = contact_.groups();
    for (std::size_t b = group.size(); b < body_.size(); ++b) group.push_back(b);
    std::vector<char> all(body_.size(), 1);
    for (std::size_t b = 0; b < body_.size(); ++b) all[group[b]] = all[group[b]] && rests[b];
    for_each_awake([&](std::size_t b) {
        if (!all[group[b]]) return;
        sleeping_.put_to_sleep(b);
        asleep_since_[b] = now;
        outcome.body[b].damped_work += outcome.body[b].after.kinetic;
        outcome.body[b].after.kinetic = held_[b].kinetic = 0;
        body_[b].stop();
    });
}

// What the state of the bodies and what the guard has asked for allow.
double ExplicitSolver::longest_step(double frame) {
    const bool is_free = is_implicit();
    double dt = !is_free ? step_ : rescued_blocks_ > 0 ? kRescueStep * step_ : kFrameShare * frame;
    for_each_awake([&](std::size_t b) {
        MovingBody& body = body_[b];
        if (!is_free) {
            const double first = body.stable_step(), share = body.present_step() / first;
            dt = std::min(dt, share * (settings_.solver == Solver::euler ? step_ : first));
        }
        const double speed = body.top_speed();
        if (speed > 0 && (!is_free || body.meets_tools()))
            dt = std::min(dt, kWayAhead * body.matter().lattice.spacing / speed);
    });
    return share_ * dt;
}

std::vector<Stored> ExplicitSolver::stored(const Drive& now, double dt) {
    for_all_awake([&](std::size_t b) {
        held_[b] = body_[b].stored(now, dt);
        if (b < met_.size()) held_[b].contact += met_[b].stored;
    });
    return held_;
}

std::vector<Stored> ExplicitSolver::still_stored(double dt) {
    for_all_awake([&](std::size_t b) { held_[b].kinetic = body_[b].kinetic_energy(dt); });
    return held_;
}

double ExplicitSolver::move(std::size_t b, const Drive& now, double dt, long n,
                            BodyOutcome& outcome) {
    MovingBody& body = body_[b];
    if (has_half_kicks()) return body.move(n == 1 ? 0.5 * dt : dt, dt);
    if (!is_implicit()) {
        const double gone = body.move(0, dt);
        body.kick(dt);
        return gone;
    }
    const Vec3Array from = body.matter().particle_position;
    if (!implicit_[b].move(body, now, dt, outcome)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (!body.meets_tools()) return 0;  // nothing that it could go through
    return std::sqrt(3.0) * farthest_move(from, body.matter().particle_position);
}

bool ExplicitSolver::can_be_rescued() const {
    return settings_.solver == Solver::explicit_steps && rescued_blocks_ == 0 &&
           body_.size() == 1 && !contact_.acts() && !body_[0].drags() &&
           ImplicitStep::cannot(body_[0].matter()) == nullptr && body_[0].cells_alone() != nullptr;
}

// Steps from `begin` to `end`, which are at most kBlock and end at a frame's end or before it.
struct ExplicitSolver::Block {
    Drive begin;
    double end, dt;
    long count;
};

void ExplicitSolver::start_books(const std::vector<Stored>& held, MoveOutcome& outcome) {
    double sum = 0;
    for (std::size_t b = 0; b < body_.size(); ++b) {
        outcome.body[b].before = held[b];
        sum += held[b].sum();
    }
    if (!started_) energy_.start(sum);
    started_ = true;
}

// The block's steps, up to the first with which something is wrong.
Finding ExplicitSolver::take(const Way& way, const Block& block, MoveOutcome& outcome) {
    const auto& [begin, end, dt, count] = block;
    in_block_ = true;
    for_all_awake([&](std::size_t b) { body_[b].begin_block(outcome.body[b]); });
    Drive before = begin;
    for (MovingBody& body : body_) body.set_implicit(is_implicit());
    for (long n = 1; n <= count; ++n) {
        throw_if_interrupted();
        const double time = n == count ? end : begin.time + double(n) * dt;
        const Drive now =
            time >= way.to.time ? way.to : drive_between(way.from, way.to, way.at(time));
        wake_stirred(before, now, dt, outcome);
        std::vector<Moved> moved(body_.size());
        for_all_awake([&](std::size_t b) {
            Moved& one = moved[b];
            body_[b].begin_step(before);
            one.way = move(b, now, dt, n, outcome.body[b]);
            one.found = look_at(body_[b], one.way, std::numeric_limits<int>::max());
            if (one.found) return;
            body_[b].find_forces(now, is_implicit() ? 0 : dt, outcome.body[b]);
            one.found = look_at(body_[b], one.way, inside_out_[b]);
        });
        for (std::size_t b = 0; b < body_.size(); ++b) {
            Finding& found = moved[b].found;
            if (!found) continue;
            found.body = b;
            found.step = steps_ + n;
            found.time = time;
            return found;
        }
        for_all_awake([&](std::size_t b) {
            const int broken = outcome.body[b].broken;
            body_[b].finish_step(before, now, dt, outcome.body[b]);
            body_[b].renew_candidates(before, now, moved[b].way);
            moved[b].broke = outcome.body[b].broken > broken;
        });
        for (std::size_t b = 0; b < body_.size(); ++b) {
            if (moved[b].broke) contact_.connections_changed(b);
        }
        if (contact_.acts()) {
            meet(now, dt, false, outcome);
            for (std::size_t b = 0; b < body_.size(); ++b) outcome.body[b].met.add(met_[b], dt);
            contact_.commit(sleeping_.asleep());
        }
        before = now;
    }
    for_all_awake([&](std::size_t b) {
        if (has_half_kicks()) body_[b].kick(0.5 * dt);
        body_[b].end_block(outcome.body[b]);
    });
    in_block_ = false;
    return {};
}

ExplicitSolver::Block ExplicitSolver::next_block(const Way& way, const Drive& begin) {
    const double left = way.to.time - begin.time;
    const double longest = longest_step(way.to.time - way.from.time);
    const double parts = std::max(1.0, std::ceil(left / longest * (1 - 1e-9)));
    if (!(parts < 1e15)) {
        fail(ExitCode::stopped, "{}: step {} at {:.6g} s would be shorter than {:.3g} s",
             apparatus_.name, steps_ + 1, begin.time, left / 1e15);
    }
    const double dt = left / parts;
    const long count = std::min(kBlock, static_cast<long>(parts));
    return {begin, double(count) == parts ? way.to.time : begin.time + double(count) * dt, dt,
            count};
}

void ExplicitSolver::save(std::size_t b) {
    body_[b].save(state_[b]);
    const bool may =
        halvings_ >= kInsideOutHalvings || share_ <= std::ldexp(1.0, -kInsideOutHalvings);
    inside_out_[b] = may ? std::numeric_limits<int>::max() : body_[b].inside_out();
}

void ExplicitSolver::save() {
    for_all_awake([&](std::size_t b) { save(b); });
    contact_state_ = contact_.save();
}

// Whether the energy of a block that went right is right too.
bool ExplicitSolver::energy_holds(const Block& block, const std::vector<Stored>& held,
                                  const std::vector<Stored>& after,
                                  const std::vector<BodyOutcome>& so_far,
                                  const std::vector<BodyOutcome>& now) {
    double turned = 0, done = 0, lost = 0, gain = 0;
    for (std::size_t b = 0; b < body_.size(); ++b) {
        turned += turned_over(so_far[b].work, now[b].work) +
                  turned_over(so_far[b].push_work, now[b].push_work);
        done += now[b].done() - so_far[b].done();
        lost += now[b].lost_since(so_far[b]);
        gain += after[b].sum() - held[b].sum();
    }
    const double at_once = has_half_kicks() && halvings_ < kSuddenHalvings
                               ? kSuddenGain
                               : std::numeric_limits<double>::infinity();
    if (energy_.accepts(turned, done, lost, gain, 0, at_once)) return true;
    double noise = 0;
    for_each_awake([&](std::size_t b) {
        const double step = std::min(block.dt, body_[b].stable_step());
        noise += double(block.count) * body_[b].round_off(step);
    });
    return energy_.accepts(turned, done, lost, gain, noise, at_once);
}

void ExplicitSolver::keep(const Block& block, MoveOutcome& outcome) {
    if (share_ <= std::ldexp(1.0, -kInsideOutHalvings)) {
        int now = 0;
        for_each_awake([&](std::size_t b) { now += body_[b].inside_out(); });
        outcome.inside_out = std::max(outcome.inside_out, now);
    }
    steps_ += block.count;
    outcome.steps += block.count;
    outcome.shortest_step = std::min(outcome.shortest_step, block.dt);
    if (rescued_blocks_ > 0) {
        outcome.rescued += block.count;
        if (--rescued_blocks_ == 0) share_ = 1;
    }
    halvings_ = 0;
    if (share_ < 1 && ++good_blocks_ == kPatience) {
        share_ *= 2;
        good_blocks_ = 0;
    }
}

// Goes back to the block's start and chooses shorter or other steps; throws where none are left.
void ExplicitSolver::take_back(const Block& block, const Finding& found,
                               const std::vector<BodyOutcome>& so_far, MoveOutcome& outcome) {
    ++halvings_;
    ++outcome.halvings;
    outcome.rejected += found.step - steps_;
    const int limit = rescued_blocks_ > 0 ? kRescueHalvings : settings_.retry_limit;
    const bool fails = halvings_ > limit || share_ < std::ldexp(1.0, -limit);
    const bool rescue = fails && can_be_rescued();
    std::string why;
    if (fails && !rescue) {
        why = sentence_of(found, body_[found.body], apparatus_.name, block.dt, settings_.solver);
    }
    const std::vector<BodyOutcome> gone_wrong = std::exchange(outcome.body, so_far);
    in_block_ = false;
    for_each_awake([&](std::size_t b) {
        body_[b].restore(state_[b], outcome.body[b]);
        body_[b].begin_step(block.begin);
        body_[b].find_forces(block.begin, 0, outcome.body[b]);
        if (gone_wrong[b].broken > outcome.body[b].broken) contact_.connections_changed(b);
    });
    contact_.restore(*contact_state_);
    meet(block.begin, first_step(block.dt), true, outcome);
    if (!why.empty()) fail(ExitCode::stopped, "{}", why);
    share_ *= 0.5;
    good_blocks_ = 0;
    if (rescue) {
        share_ = 1;
        rescued_blocks_ = kRescue;
        halvings_ = 0;
    }
}

MoveOutcome ExplicitSolver::advance(const Drive& from, const Drive& to) {
    MoveOutcome outcome;
    outcome.body.assign(body_.size(), BodyOutcome(apparatus_, body_[0].pushes().count()));
    outcome.shortest_step = to.time - from.time;
    const Way way{from, to};
    for_each_awake([&](std::size_t b) { body_[b].start(from, outcome.body[b]); });
    meet(from, first_step(share_ * step_), true, outcome);
    for (std::size_t b = 0; b < met_.size(); ++b) outcome.body[b].met.start(met_[b]);
    halvings_ = 0;
    bool goes_on = false;  // from the end of a block that was kept
    bool is_begun = false;
    for (Drive begin = from; begin.time < to.time;) {
        const Block block = next_block(way, begin);
        const double lag = has_half_kicks() ? block.dt : 0;
        const std::vector<Stored> held = goes_on ? still_stored(lag) : stored(begin, lag);
        // Once: what is taken back may let go of what the damping holds.
        if (!std::exchange(is_begun, true)) start_books(held, outcome);
        save();
        const std::vector<BodyOutcome> so_far = outcome.body;
        Finding found = take(way, block, outcome);
        const Drive now = block.end >= to.time ? to : drive_between(from, to, way.at(block.end));
        if (!found) {
            const std::vector<Stored> after = stored(now, lag);
            for (std::size_t b = 0; b < body_.size(); ++b) outcome.body[b].after = after[b];
            if (!energy_holds(block, held, after, so_far, outcome.body)) {
                found.fault = Fault::gains;
                found.gain = energy_.excess_share();
                found.step = steps_ + block.count;
                found.time = block.end;
            }
        }
        goes_on = !found;
        if (found) {
            take_back(block, found, so_far, outcome);
        } else {
            keep(block, outcome);
            put_to_sleep(now, outcome);
            begin = now;
        }
    }
    for (std::size_t b = 0; b < body_.size(); ++b) {
        outcome.body[b].load = body_[b].load();
        outcome.drag_held = outcome.drag_held || body_[b].drag_is_held();
        outcome.asleep += sleeping_.is_asleep(b);
    }
    return outcome;
}

}  // namespace swage
