// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/energy_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "geometry/box.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr double kTolerance = 1e-9;  // of all energy that was put in, that a step may gain
constexpr double kMistake = 1e-6;    // likewise, that it may lose where no book says so
constexpr double kFinest = 1e-6;     // of the stable step; shorter ones may lose more
constexpr double kWay = 0.3;         // spacings that the fastest particle may go in a step
constexpr double kShortest = 1e-9;   // of the stable step of explicit steps

double acceleration_of(const MovingBody& body) {
    double most = 0;
    for (std::size_t p = 0; p < body.matter().particle_count(); ++p) {
        most = std::max(most, body.acceleration(p).squaredNorm());
    }
    return std::sqrt(most);
}

// Of all particles, grown by how far they may get in a time.
Box reach_of(const MovingBody& body, double time) {
    const Aggregate& m = body.matter();
    Box box;
    for (std::size_t p = 0; p < m.particle_count(); ++p) box.grow(m.particle_position.at(p));
    const double far =
        m.lattice.spacing + 1.5 * time * body.top_speed() + time * time * acceleration_of(body);
    box.low.array() -= far;
    box.high.array() += far;
    return box;
}

// Of its energy, by what places are rounded to [J].
double round_off(MovingBody& body) {
    const Vec3Array& x = body.matter().particle_position;
    return std::numeric_limits<double>::epsilon() * chunked_sum(x.size(), [&](std::size_t p) {
               return body.force().at(p).cwiseAbs().dot(x.at(p).cwiseAbs());
           });
}

Vec3Array mean_speed(const Vec3Array& from, const Vec3Array& to, double step) {
    Vec3Array speed;
    speed.resize(from.size());
    for (std::size_t p = 0; p < from.size(); ++p) speed.set(p, (to.at(p) - from.at(p)) / step);
    return speed;
}

bool meet(const Box& a, const Box& b) {
    return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
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
    : apparatus_(apparatus) {
    mover_.reserve(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        mover_.push_back({MovingBody(*bodies[b], static_cast<int>(b), apparatus, settings)});
    }
}

// Bodies whose boxes may meet within the frame, in the order of their first.
std::vector<EnergySteps::Group> EnergySteps::groups(const Drive& from, const Drive& to) const {
    std::vector<Box> reach;
    for (const Mover& mover : mover_) reach.push_back(reach_of(mover.body, to.time - from.time));
    std::vector<std::size_t> first(mover_.size());
    for (std::size_t b = 0; b < first.size(); ++b) first[b] = b;
    for (std::size_t a = 0; a < first.size(); ++a) {
        for (std::size_t b = a + 1; b < first.size(); ++b) {
            if (first[a] == first[b] || !meet(reach[a], reach[b])) continue;
            const std::size_t low = std::min(first[a], first[b]),
                              high = std::max(first[a], first[b]);
            for (std::size_t& f : first) f = f == high ? low : f;
        }
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

double EnergySteps::step_to_try(const Group& group, double left) const {
    double step = left;
    for (std::size_t b : group) {
        const Mover& m = mover_[b];
        if (m.step > 0) step = std::min(step, m.step);
        // v t + a t^2 <= far
        const double far = kWay * m.body.matter().lattice.spacing, v = m.body.top_speed(),
                     a = acceleration_of(m.body);
        const double root = v + std::sqrt(v * v + 4 * a * far);
        if (root > 0) step = std::min(step, 2 * far / root);
    }
    return left / std::max(1.0, std::ceil(left / step * (1 - 1e-9)));
}

void EnergySteps::advance(const Group& group, const Drive& from, const Drive& to,
                          MoveOutcome& outcome) {
    Drive begin = from;
    std::vector<Stored> held(mover_.size());
    const auto sum_over = [&](const auto& of) {
        double sum = 0;
        for (std::size_t b : group) sum += of(b);
        return sum;
    };
    for (std::size_t b : group) {
        held[b] = outcome.body[b].before = mover_[b].body.stored(from, 0);
        if (mover_[b].step == 0) mover_[b].budget = std::max(held[b].sum(), 0.0);
    }
    while (begin.time < to.time) {
        const double left = to.time - begin.time;
        const double step = step_to_try(group, left);
        const double end = step >= left ? to.time : begin.time + step;
        const Drive now = end >= to.time
                              ? to
                              : drive_between(from, to, (end - from.time) / (to.time - from.time));
        Finding found;
        std::vector<BodyOutcome> so_far;
        std::vector<Vec3Array> earlier;
        for (std::size_t b : group) {
            Mover& m = mover_[b];
            so_far.push_back(outcome.body[b]);
            earlier.push_back(m.before);
            m.body.save(m.state);
            m.body.begin_step(begin);
            m.body.begin_block(outcome.body[b]);
            const Vec3Array was = m.body.matter().particle_position;
            carry_on(m.body, step, m.last_step, m.before);
            find_forces_of_step(m.body, now, was, step, outcome.body[b]);
            m.body.finish_step(begin, now, step, outcome.body[b]);
            m.body.end_block(outcome.body[b]);
            m.body.renew_candidates(
                begin, now, std::sqrt(3.0) * farthest_move(was, m.body.matter().particle_position));
        }
        std::vector<Stored> after(mover_.size());
        for (std::size_t b : group) after[b] = mover_[b].body.stored(now, 0);
        std::size_t n = 0;
        double done = 0, turned = 0;
        for (std::size_t b : group) {
            const BodyOutcome& was = so_far[n++];
            done += outcome.body[b].done() - was.done();
            turned += std::abs(outcome.body[b].done() - was.done());
        }
        const double budget = turned + sum_over([&](std::size_t b) { return mover_[b].budget; });
        const double gain =
            sum_over([&](std::size_t b) { return after[b].sum() - held[b].sum(); }) - done;
        double lost = 0, shortest = std::numeric_limits<double>::infinity();
        n = 0;
        for (std::size_t b : group) {
            lost += outcome.body[b].lost() - so_far[n++].lost();
            shortest = std::min(shortest, mover_[b].body.stable_step());
        }
        double noise = 0;
        const auto within = [&](double error, double share) {
            if (error <= share * budget) return true;
            if (noise == 0)
                noise = sum_over([&](std::size_t b) { return round_off(mover_[b].body); });
            return error <= share * budget + noise;
        };
        const bool keeps = within(gain, kTolerance) &&
                           (within(std::abs(gain + lost), kMistake) || step < kFinest * shortest);
        if (tried_ != nullptr) tried_->push_back({begin.time, step, gain + lost, keeps});
        if (keeps) {
            n = 0;
            for (std::size_t b : group) {
                Mover& m = mover_[b];
                const BodyOutcome& was = so_far[n++];
                m.budget += std::abs(outcome.body[b].done() - was.done());
                m.last_step = step;
                m.step = m.held ? step : 1.5 * step;
                m.held = false;
            }
            held = std::move(after);
            begin = now;
            ++outcome.steps;
            ++steps_;
            outcome.shortest_step = std::min(outcome.shortest_step, step);
            continue;
        }
        ++outcome.rejected;
        ++outcome.halvings;
        found.fault = std::isfinite(gain) ? Fault::gains : Fault::lost;
        found.body = group[0];
        found.step = steps_ + 1;
        found.time = end;
        found.gain = gain / budget;
        n = 0;
        const bool gives_up = !(step > kShortest * shortest);
        const std::string why =
            gives_up ? sentence_of(found, mover_[group[0]].body, apparatus_.name, step)
                     : std::string();
        for (std::size_t b : group) {
            Mover& m = mover_[b];
            outcome.body[b] = so_far[n];
            m.before = earlier[n++];
            m.body.restore(m.state);
            m.body.begin_step(begin);
            m.body.find_forces(begin, 0, outcome.body[b]);
            m.step = 0.5 * step;
            m.held = true;
        }
        if (gives_up) fail(ExitCode::stopped, "{}", why);
    }
    for (std::size_t b : group) outcome.body[b].after = held[b];
}

MoveOutcome EnergySteps::advance(const Drive& from, const Drive& to) {
    MoveOutcome outcome;
    outcome.body.assign(mover_.size(), BodyOutcome(apparatus_, pushes(0).count()));
    outcome.shortest_step = to.time - from.time;
    for (std::size_t b = 0; b < mover_.size(); ++b) mover_[b].body.start(from, outcome.body[b]);
    for (const Group& group : groups(from, to)) advance(group, from, to, outcome);
    for (std::size_t b = 0; b < mover_.size(); ++b) {
        outcome.body[b].load = mover_[b].body.load();
        outcome.drag_held = outcome.drag_held || mover_[b].body.drag_is_held();
    }
    return outcome;
}

}  // namespace swage
