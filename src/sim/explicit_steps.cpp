// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/explicit_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace swage {

ExplicitSolver::ExplicitSolver(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                               const SimSettings& settings)
    : apparatus_(apparatus),
      settings_(settings),
      spacing_(std::numeric_limits<double>::infinity()),
      step_(spacing_) {
    body_.reserve(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        body_.emplace_back(*bodies[b], static_cast<int>(b), apparatus, settings);
        spacing_ = std::min(spacing_, bodies[b]->lattice.spacing);
        step_ = std::min(step_, body_[b].stable_step());
    }
    for (MovingBody& body : body_) body.limit_stiffness(step_);
}

void ExplicitSolver::connections_changed(std::size_t body) {
    body_[body].connections_changed();  // fewer are never faster, so the step stays
}

bool ExplicitSolver::steps(const Drive& from, const Drive& to, double dt, MoveOutcome& outcome) {
    const double duration = to.time - from.time;
    const long count = std::max(1L, static_cast<long>(std::ceil(duration / dt)));
    dt = duration / static_cast<double>(count);
    for (std::size_t b = 0; b < body_.size(); ++b) body_[b].begin_steps(from, outcome.body[b]);
    Drive before = from;
    for (long n = 1; n <= count; ++n) {
        const Drive now = n == count ? to : drive_between(from, to, double(n) / double(count));
        for (std::size_t b = 0; b < body_.size(); ++b) {
            body_[b].find_forces(before, now, dt, outcome.body[b]);
        }
        for (MovingBody& body : body_) {
            if (!body.move(now, dt)) return false;
        }
        for (std::size_t b = 0; b < body_.size(); ++b) {
            body_[b].commit(before, now, outcome.body[b]);
            const double way = body_[b].travel() + body_[b].tool_travel(before, now) * double(n);
            if (way > 0.45 * body_[b].matter().lattice.spacing) body_[b].find_candidates(now);
        }
        before = now;
    }
    for (std::size_t b = 0; b < body_.size(); ++b) body_[b].end_steps(outcome.body[b]);
    outcome.steps += count;
    return true;
}

MoveOutcome ExplicitSolver::advance(const Drive& from, const Drive& to) {
    MoveOutcome outcome;
    std::vector<std::shared_ptr<const MovingBody::State>> start;
    for (MovingBody& body : body_) {
        body.start(from);
        start.push_back(body.save());
    }
    double dt = step_;
    for (;; dt *= 0.5, ++outcome.halvings) {
        outcome.body.assign(body_.size(), BodyOutcome(apparatus_, body_[0].pushes().count()));
        if (steps(from, to, dt, outcome)) break;
        for (std::size_t b = 0; b < body_.size(); ++b) body_[b].restore(*start[b]);
        if (outcome.halvings == settings_.halving_limit) {
            fail(ExitCode::stopped,
                 "{}: the motion is not finite at {:.4g} s even with steps of {:.3g} s; move the "
                 "tools slower (a longer duration) or use solver = \"quasistatic\"",
                 apparatus_.name, to.time, dt);
        }
    }
    for (std::size_t b = 0; b < body_.size(); ++b) {
        outcome.body[b].load = body_[b].load();
        outcome.drag_held = outcome.drag_held || body_[b].drag_is_held();
    }
    return outcome;
}

}  // namespace swage
