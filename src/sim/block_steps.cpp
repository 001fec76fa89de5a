// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/block_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr long kBlock = 64;         // steps
constexpr double kWayAhead = 0.3;   // spacings that the fastest particle, or tool, goes in a step
constexpr int kPatience = 8;        // blocks until a halved step is doubled again
constexpr double kLegShare = 0.25;  // of a leg, in an implicit step
constexpr double kRescueStep = 64;  // explicit steps in an implicit one that stands in for them
constexpr int kRescueHalvings = 10;
constexpr long kRescue = 4;                                         // blocks of these
constexpr double kCrushingShare = 1.0 / (1 << kInsideOutHalvings);  // of a step

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

}  // namespace

BlockSolver::BlockSolver(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                         const SimSettings& settings)
    : apparatus_(apparatus),
      settings_(settings),
      bodies_(bodies, apparatus, settings),
      step_(std::numeric_limits<double>::infinity()),
      implicit_(bodies.size()) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        step_ = std::min(step_, step_of(b));
    }
    limit_stiffness();
}

void BlockSolver::limit_stiffness() {
    if (settings_.solver != Solver::implicit_steps) bodies_.limit_stiffness(step_);
}

double BlockSolver::step_of(std::size_t body) const {
    const MovingBody& of = bodies_[body];
    return settings_.solver == Solver::euler ? euler_step(of.matter(), of) : of.stable_step();
}

void BlockSolver::masses_changed(std::size_t body, const std::vector<double>& was) {
    const double before = bodies_[body].stable_step();
    bodies_.masses_changed(body, was);
    if (bodies_[body].stable_step() >= before) return;
    step_ = std::min(step_, step_of(body));
    limit_stiffness();
}

double BlockSolver::connections_changed(std::size_t body, const Drive& now) {
    implicit_[body] = {};
    return bodies_.connections_changed(body, now);  // fewer are never faster, so the step stays
}

// What the state of the bodies, tools that come near and what the guard has asked for allow.
double BlockSolver::longest_step(const Way& way, const Drive& begin) {
    const bool is_free = is_implicit();
    const double leg = way.to.time - way.from.time, left = way.to.time - begin.time;
    double dt = !is_free ? step_ : rescued_blocks_ > 0 ? kRescueStep * step_ : kLegShare * leg;
    bodies_.for_each_awake([&](std::size_t b) {
        MovingBody& body = bodies_[b];
        if (!is_free) {
            const double first = body.stable_step(), share = body.present_step() / first;
            dt = std::min(dt, share * (settings_.solver == Solver::euler ? step_ : first));
        }
        const double speed = body.top_speed();
        if (speed > 0 && (!is_free || body.meets_tools()))
            dt = std::min(dt, kWayAhead * body.matter().lattice.spacing / speed);
        if (is_free) return;
        const double ahead = std::min(left, double(kBlock) * dt);
        const double travel = body.drive_travel(begin, way.at(begin.time + ahead));
        if (travel > 0)
            dt = std::min(dt, kWayAhead * body.matter().lattice.spacing * (ahead / travel));
    });
    return share_ * dt;
}

double BlockSolver::move(std::size_t b, const Drive& now, double dt, BodyOutcome& outcome) {
    MovingBody& body = bodies_[b];
    if (has_half_kicks()) return body.move(body.is_in_time() ? 0.5 * dt : dt, dt);
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

bool BlockSolver::may_crush() const {
    return halvings_ >= kInsideOutHalvings || share_ <= kCrushingShare;
}

bool BlockSolver::can_be_rescued() const {
    return settings_.solver == Solver::explicit_steps && rescued_blocks_ == 0 &&
           bodies_.size() == 1 && !bodies_.may_meet() && !bodies_[0].drags() &&
           ImplicitStep::cannot(bodies_[0].matter()) == nullptr &&
           bodies_[0].cells_alone() != nullptr;
}

// Steps from `begin` to `end`, which are at most kBlock and end at a leg's end or before it; or one
// as long as a free flight.
struct BlockSolver::Block {
    Drive begin;
    double end, dt;
    long count;
    bool flies = false;
};

// Of a try, which may not be the first: speeds are then as shorter steps have them, and what the
// damping held and was let go of still counts.
void BlockSolver::start_books(const std::vector<Stored>& before, bool again, MoveOutcome& outcome) {
    double sum = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        Stored& start = outcome.body[b].before;
        const double elastic = again ? start.elastic : before[b].elastic;
        start = before[b];
        start.elastic = elastic;
        start.contact += outcome.body[b].by_contact.damped;  // let go of as it began
        sum += before[b].sum();
    }
    if (!started_) energy_.start(sum);
    started_ = true;
}

// The block's steps, up to the first with which something is wrong.
Finding BlockSolver::take(const Way& way, const Block& block, MoveOutcome& outcome) {
    const auto& [begin, end, dt, count, flies] = block;
    bodies_.begin_block(is_implicit(), outcome);
    if (flies) {
        bodies_.fly(begin, way.at(end), first_step(share_ * step_), outcome);
        bodies_.end_block(outcome);
        return {};
    }
    Drive before = begin;
    for (long n = 1; n <= count; ++n) {
        throw_if_interrupted();
        const double time = n == count ? end : begin.time + double(n) * dt;
        const Drive now = way.at(time);
        bodies_.wake_stirred(before, now, dt, outcome);
        std::vector<double> gone(bodies_.size(), 0.0);
        std::vector<Finding> found(bodies_.size());
        bodies_.for_all_awake([&](std::size_t b) {
            MovingBody& body = bodies_[b];
            body.begin_step(before);
            gone[b] = move(b, now, dt, outcome.body[b]);
            found[b] = look_at(body, gone[b], std::numeric_limits<int>::max());
            if (found[b]) return;
            body.find_forces(now, is_implicit() ? 0 : dt, outcome.body[b]);
            found[b] = look_at(body, gone[b], bodies_.may_be_inside_out(b));
        });
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (!found[b]) continue;
            found[b].body = b;
            found[b].step = steps_ + n;
            found[b].time = time;
            return found[b];
        }
        bodies_.finish_step(before, now, dt, gone, outcome);
        before = now;
    }
    if (has_half_kicks()) {
        bodies_.for_all_awake([&](std::size_t b) {
            if (!bodies_[b].is_in_time()) bodies_[b].kick(0.5 * dt);
        });
    }
    bodies_.end_block(outcome);
    return {};
}

BlockSolver::Block BlockSolver::next_block(const Way& way, const Drive& begin) {
    const double left = way.to.time - begin.time;
    const double longest = longest_step(way, begin);
    if (has_half_kicks() && halvings_ == 0) {
        const double free = bodies_.free_time(way.from, way.to, begin);
        if (free > kWorthFlying * longest) {
            const double flight = std::min(free, left);
            return {begin, free < left ? begin.time + free : way.to.time, flight, 1, true};
        }
    }
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

// Whether the energy of a block that went right is right too.
bool BlockSolver::energy_holds(const Block& block, const std::vector<Stored>& before,
                               const std::vector<Stored>& after,
                               const std::vector<BodyOutcome>& so_far,
                               const std::vector<BodyOutcome>& now) {
    double turned = 0, done = 0, lost = 0, gain = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        turned += turned_over(so_far[b].work, now[b].work) +
                  turned_over(so_far[b].load_work, now[b].load_work);
        done += now[b].done() - so_far[b].done();
        lost += now[b].lost_since(so_far[b]);
        gain += after[b].sum() - before[b].sum();
    }
    const double at_once = has_half_kicks() && halvings_ < kSuddenHalvings
                               ? kSuddenGain
                               : std::numeric_limits<double>::infinity();
    if (energy_.accepts(turned, done, lost, gain, 0, at_once)) return true;
    double noise = 0;
    bodies_.for_each_awake([&](std::size_t b) {
        const double step = std::min(block.dt, bodies_[b].stable_step());
        noise += double(block.count) * bodies_[b].round_off(step);
    });
    return energy_.accepts(turned, done, lost, gain, noise, at_once);
}

void BlockSolver::keep(const Block& block, MoveOutcome& outcome) {
    if (share_ <= kCrushingShare) {
        int now = 0;
        bodies_.for_each_awake([&](std::size_t b) { now += bodies_[b].inside_out(); });
        outcome.inside_out = std::max(outcome.inside_out, now);
    }
    steps_ += block.count;
    outcome.steps += block.count;
    if (!block.flies) outcome.shortest_step = std::min(outcome.shortest_step, block.dt);
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

// Goes back to the block's start and chooses shorter or other steps; where none are left it says
// why.
std::string BlockSolver::take_back(const Block& block, const Finding& found,
                                   const std::vector<BodyOutcome>& so_far, MoveOutcome& outcome) {
    ++halvings_;
    ++outcome.halvings;
    outcome.rejected += found.step - steps_;
    const int limit = rescued_blocks_ > 0 ? kRescueHalvings : settings_.retry_limit;
    const bool fails = halvings_ > limit || share_ < std::ldexp(1.0, -limit);
    const bool rescue = fails && can_be_rescued();
    std::string why;
    if (fails && !rescue) {
        why = sentence_of(found, bodies_[found.body], apparatus_.name, block.dt, settings_.solver);
    }
    bodies_.restore(block.begin, first_step(block.dt), so_far, outcome);
    if (!why.empty()) return why;
    share_ *= 0.5;
    good_blocks_ = 0;
    if (rescue) {
        share_ = 1;
        rescued_blocks_ = kRescue;
        halvings_ = 0;
    }
    return {};
}

MoveOutcome BlockSolver::advance(const Drive& from, const Drive& to) {
    MoveOutcome outcome;
    outcome.body.assign(bodies_.size(), BodyOutcome(apparatus_, bodies_[0].pushes().count()));
    outcome.shortest_step = to.time - from.time;
    const Way way{from, to};
    bodies_.start(from, first_step(share_ * step_), outcome);
    halvings_ = 0;
    bool goes_on = false;  // from the end of a block that was kept
    bool is_begun = false;
    for (Drive begin = from; begin.time < to.time;) {
        const Block block = next_block(way, begin);
        const double lag = has_half_kicks() && !block.flies ? block.dt : 0;
        const std::vector<Stored> before =
            goes_on ? bodies_.still_stored(lag) : bodies_.stored(begin, lag);
        if (begin.time == from.time) start_books(before, std::exchange(is_begun, true), outcome);
        bodies_.save(may_crush());
        const std::vector<BodyOutcome> so_far = outcome.body;
        Finding found = take(way, block, outcome);
        const Drive now = way.at(block.end);
        if (!found) {
            const std::vector<Stored> after = bodies_.stored(now, lag);
            for (std::size_t b = 0; b < bodies_.size(); ++b) outcome.body[b].after = after[b];
            if (!energy_holds(block, before, after, so_far, outcome.body)) {
                found.fault = Fault::gains;
                found.gain = energy_.excess_share();
                found.step = steps_ + block.count;
                found.time = block.end;
            }
        }
        goes_on = !found;
        if (found) {
            const std::string why = take_back(block, found, so_far, outcome);
            if (why.empty()) continue;
            outcome.given_up = {Error(ExitCode::stopped, why), begin};
            const std::vector<Stored> kept = bodies_.stored(begin, lag);
            if (begin.time == from.time) start_books(kept, true, outcome);
            for (std::size_t b = 0; b < bodies_.size(); ++b) outcome.body[b].after = kept[b];
            break;
        }
        keep(block, outcome);
        bodies_.put_to_sleep(now, outcome);
        begin = now;
    }
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        outcome.body[b].part = bodies_[b].load();
        outcome.asleep += bodies_.is_asleep(b);
    }
    return outcome;
}

}  // namespace swage
