// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/explicit_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace swage {

namespace {

constexpr long kBlock = 64;       // steps
constexpr double kWayAhead = 0.3; // spacings a step that the fastest particle is given
constexpr int kPatience = 8;      // blocks until a halved step is doubled again

// What was done, whether for or against.
double turned_over(const std::vector<double>& before, const std::vector<double>& after) {
    double sum = 0;
    for (std::size_t n = 0; n < after.size(); ++n) sum += std::abs(after[n] - before[n]);
    return sum;
}

}  // namespace

ExplicitSolver::ExplicitSolver(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                               const SimSettings& settings)
    : apparatus_(apparatus),
      settings_(settings),
      state_(bodies.size()),
      step_(std::numeric_limits<double>::infinity()),
      inside_out_(bodies.size(), 0) {
    body_.reserve(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        body_.emplace_back(*bodies[b], static_cast<int>(b), apparatus, settings);
        step_ = std::min(step_, body_[b].stable_step());
    }
    for (MovingBody& body : body_) body.limit_stiffness(step_);
}

void ExplicitSolver::connections_changed(std::size_t body) {
    body_[body].connections_changed();  // fewer are never faster, so the step stays
}

// What the state of the bodies and what the guard has asked for allow.
double ExplicitSolver::longest_step() {
    double dt = share_ * step_;
    for (MovingBody& body : body_) {
        dt = std::min(dt, share_ * body.present_step());
        const double speed = body.top_speed();
        if (speed > 0) dt = std::min(dt, kWayAhead * body.matter().lattice.spacing / speed);
    }
    return dt;
}

std::vector<Stored> ExplicitSolver::stored(const Drive& now, double dt) {
    std::vector<Stored> held;
    for (MovingBody& body : body_) held.push_back(body.stored(now, dt));
    return held;
}

// `count` steps of dt from a drive on, the last of which ends at the time `end`.
Finding ExplicitSolver::block(const Way& way, const Drive& begin, double end, long count, double dt,
                              MoveOutcome& outcome) {
    Drive before = begin;
    for (long n = 1; n <= count; ++n) {
        const double time = n == count ? end : begin.time + double(n) * dt;
        const Drive now = time >= way.to.time ? way.to : drive_between(way.from, way.to, way.at(time));
        std::vector<double> gone(body_.size());
        for (std::size_t b = 0; b < body_.size(); ++b) {
            body_[b].begin_step(before);
            gone[b] = body_[b].move(n == 1 ? 0.5 * dt : dt, dt);
        }
        for (std::size_t b = 0; b < body_.size(); ++b) {
            Finding found;
            found = look_at(body_[b], gone[b], std::numeric_limits<int>::max());
            if (!found) {
                body_[b].find_forces(now, dt, outcome.body[b]);
                found = look_at(body_[b], gone[b], inside_out_[b]);
            }
            if (!found) continue;
            found.body = b;
            found.step = steps_ + n;
            found.time = time;
            return found;
        }
        for (std::size_t b = 0; b < body_.size(); ++b) {
            body_[b].finish_step(before, now, outcome.body[b]);
            body_[b].renew_candidates(before, now, gone[b]);
        }
        before = now;
    }
    for (MovingBody& body : body_) body.kick(0.5 * dt);
    return {};
}

MoveOutcome ExplicitSolver::advance(const Drive& from, const Drive& to) {
    MoveOutcome outcome;
    outcome.body.assign(body_.size(), BodyOutcome(apparatus_, body_[0].pushes().count()));
    const Way way{from, to};
    double dt = step_;
    for (std::size_t b = 0; b < body_.size(); ++b) {
        body_[b].start(from, outcome.body[b]);
    }
    std::vector<Stored> held;
    Drive begin = from;
    int halvings = 0;  // of this block
    outcome.shortest_step = step_;
    while (begin.time < to.time) {
        const double left = to.time - begin.time;
        const double parts = std::ceil(left / longest_step() * (1 - 1e-9));
        if (!(parts < 1e15)) {
            fail(ExitCode::stopped, "{}: step {} at {:.6g} s would be shorter than {:.3g} s",
                 apparatus_.name, steps_ + 1, begin.time, left / 1e15);
        }
        dt = left / std::max(parts, 1.0);
        const long count = std::min(kBlock, static_cast<long>(std::max(parts, 1.0)));
        const double end =
            double(count) == parts ? to.time : begin.time + double(count) * dt;
        held = stored(begin, dt);
        if (begin.time == from.time) {
            double sum = 0;
            for (std::size_t b = 0; b < body_.size(); ++b) {
                outcome.body[b].before = held[b];
                sum += held[b].sum();
            }
            if (!started_) energy_.start(sum);
            started_ = true;
        }
        for (std::size_t b = 0; b < body_.size(); ++b) {
            body_[b].save(state_[b]);
            inside_out_[b] = halvings >= kInsideOutHalvings ? std::numeric_limits<int>::max()
                                                            : body_[b].inside_out();
        }
        const std::vector<BodyOutcome> so_far = outcome.body;
        Finding found = block(way, begin, end, count, dt, outcome);
        const Drive now = end >= to.time ? to : drive_between(from, to, way.at(end));
        if (!found) {
            const std::vector<Stored> after = stored(now, dt);
            double turned = 0, done = 0, lost = 0, gain = 0;
            for (std::size_t b = 0; b < body_.size(); ++b) {
                const BodyOutcome& was = so_far[b];
                BodyOutcome& is = outcome.body[b];
                turned += turned_over(was.work, is.work) + turned_over(was.push_work, is.push_work);
                done += is.done() - was.done();
                lost += is.lost() - was.lost();
                gain += after[b].sum() - held[b].sum();
                is.after = after[b];
            }
            if (!energy_.accepts(turned, done, lost, gain)) {
                found.fault = Fault::gains;
                found.gain = energy_.excess_share();
                found.step = steps_ + count;
                found.time = end;
            }
        }
        if (!found) {
            if (halvings >= kInsideOutHalvings) {
                for (MovingBody& body : body_) outcome.inside_out += body.inside_out();
            }
            begin = now;
            steps_ += count;
            outcome.steps += count;
            outcome.shortest_step = std::min(outcome.shortest_step, dt);
            halvings = 0;
            if (share_ < 1 && ++good_blocks_ == kPatience) {
                share_ *= 2;
                good_blocks_ = 0;
            }
            continue;
        }
        ++halvings;
        ++outcome.halvings;
        outcome.rejected += found.step - steps_;
        const bool gives_up = halvings > settings_.retry_limit;
        const std::string why =
            gives_up ? sentence_of(found, body_[found.body], apparatus_.name, dt) : std::string();
        outcome.body = so_far;
        for (std::size_t b = 0; b < body_.size(); ++b) {
            body_[b].restore(state_[b]);
            body_[b].begin_step(begin);
            body_[b].find_forces(begin, 0, outcome.body[b]);
        }
        if (gives_up) fail(ExitCode::stopped, "{}", why);
        share_ = 0.5 * std::min(share_, dt / step_);
        good_blocks_ = 0;
    }
    for (std::size_t b = 0; b < body_.size(); ++b) {
        outcome.body[b].load = body_[b].load();
        outcome.drag_held = outcome.drag_held || body_[b].drag_is_held();
    }
    return outcome;
}

}  // namespace swage
