// SPDX-License-Identifier: GPL-3.0-or-later
// Contact with tools and grips in explicit steps: the other half of sim/contact_set.h.
#include <algorithm>

#include "base/parallel.h"
#include "sim/contact_set.h"
#include "sim/surface_forces.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;  // points

}  // namespace

// A point that touches, or is still held.
struct ContactSet::Meeting {
    std::size_t pair;
    // Speeds of explicit steps stand half a step before the forces. Where these are found anew, at
    // the start of a frame, they have moved on; those of then give the same forces again.
    bool has_speed;
    Vec3 speed;
    double depth;
    Vec3 place, normal;
    Vec3 reach;   // to where it sticks
    Vec3 spring;  // force that it would have without a speed [N]
    ImpactLaw law;
    ImpactForce result;
};

void ContactSet::begin_step(const Drive& from) {
    world_from_tool_at_start_ = from.world_from_tool;
    for (Pair& pair : pair_) {
        pair.last = pair.next;
        if (pair.gone) pair.next.friction = 0;  // taken by the step before
    }
}

std::vector<ContactSet::Meeting> ContactSet::find_meetings(const Aggregate& matter,
                                                           const Drive& now, bool anew) {
    std::vector<Pose> tool_from_world;
    for (const Pose& pose : now.world_from_tool) tool_from_world.push_back(pose.inverse());
    const auto find = [&](std::size_t begin, std::size_t end, std::vector<Meeting>& met) {
        for (std::size_t n = begin; n < end; ++n) {
            Pair& pair = pair_[n];
            if (pair.gone) continue;
            const Tool& tool = apparatus_->tool[pair.tool];
            const Pose& pose = now.world_from_tool[pair.tool];
            const Vec3 x = points().position(std::size_t(pair.point), matter.particle_position);
            const Touch found = pair.next;
            pair.next = {.local = tool_from_world[pair.tool] * x};
            const double hold = stickiness_ * points().area(pair.point);
            const Distance d = distance_of(pair, pair.last.local, pair.next.local, pair.next.entry);
            pair.next.depth = -d.value;
            if (d.value >= 0 && !(pair.history.touches && hold > 0)) continue;
            Meeting m;
            m.pair = n;
            m.has_speed = anew && found.history.touches;
            m.speed = found.speed;
            m.depth = -d.value;
            m.place = x;
            m.normal = pose.turn(d.normal);
            m.law = law_;
            m.law.stiffness = pair_stiffness(pair);
            const double friction = tool.friction_on(body_);
            m.law.friction = friction;
            m.law.holding = friction == law_.friction ? holding_ : ratio_ * friction;
            m.law.hold = hold;
            const double k = m.law.stiffness;
            if (d.value >= 0 && !is_bound(k, m.depth, hold)) continue;  // torn off
            const double N = spring_push(k, m.depth, hold), bears = N + hold;
            const Vec3 way = pair.history.touches ? Vec3(pose * pair.anchor - x) : Vec3::Zero();
            m.reach = way - m.normal * m.normal.dot(way);
            const double limit = (pair.history.slides ? m.law.friction : m.law.holding) * bears / k;
            const double size = m.reach.norm();
            m.spring = N * m.normal + k * std::min(1.0, size > 0 ? limit / size : 1.0) * m.reach;
            met.push_back(m);
        }
    };
    return parallel_collect<Meeting>(pair_.size(), kChunk, find);
}

void ContactSet::add_motion_forces(const Aggregate& matter, const Drive& now, double step,
                                   const Vec3& gravity, Vec3Array& force) {
    if (step > 0) {
        last_step_ = way_step_ = step;
        for (std::size_t t = 0; t < tool_way_.size(); ++t) {
            tool_way_[t] = {world_from_tool_at_start_[t], now.world_from_tool[t]};
        }
    }
    motion_load_.assign(motion_load_.size(), {});
    motion_energy_ = grips_.add_all(matter, now, force, tool_way_.size(), motion_load_);
    if (!pair_.empty()) meet(matter, now, step == 0, gravity, force);
}

void ContactSet::meet(const Aggregate& matter, const Drive& now, bool anew, const Vec3& gravity,
                      Vec3Array& force) {
    std::vector<Meeting> meeting = find_meetings(matter, now, anew);
    if (meeting.empty()) return;
    const double step = last_step_;
    const SurfacePoints& surface = points();
    bears_.resize(matter.particle_count(), 0.0);
    for (const Meeting& m : meeting) {
        const int point = pair_[m.pair].point;
        spread(surface, point, m.spring, force);
        const SurfacePoints::Carriers by = surface.carriers(static_cast<std::size_t>(point));
        for (int c = 0; c < 8; ++c) {
            bears_[by.corner[c]] += std::abs(by.weight[c]) * m.law.stiffness;
        }
    }
    met_.resize(matter.particle_count(), 0.0);
    const bool is_met = std::any_of(meeting.begin(), meeting.end(), [&](const Meeting& m) {
        return !pair_[m.pair].history.touches;
    });
    for (const Meeting& m : meeting) {
        const Pair& pair = pair_[m.pair];
        if (!is_met || !pair.history.touches || pair.history.rests) continue;
        for (ParticleId p : surface.corner(pair.point)) {
            met_[p] = std::max(met_[p], pair.history.speed);
        }
    }
    parallel_each(meeting.size(), kChunk, [&](std::size_t n) {
        Meeting& m = meeting[n];
        const Pair& pair = pair_[m.pair];
        Vec3 v = Vec3::Zero(), push = gravity;
        double give = 0, beside = 0;  // give: S
        const auto by = surface.carriers(static_cast<std::size_t>(pair.point));
        for (int c = 0; c < 8; ++c) {
            beside = std::max(beside, met_[by.corner[c]]);
            const double w = by.weight[c];
            if (w == 0) continue;
            const ParticleId p = by.corner[c];
            const double lightness = w / matter.particle_mass[p];
            v += w * matter.particle_velocity.at(p);
            push += lightness * force.at(p);
            give += std::abs(lightness) * bears_[p];
        }
        give /= m.law.stiffness;
        if (way_step_ > 0) {
            const ToolWay& way = tool_way_[pair.tool];
            v -= (way.to * pair.next.local - way.from * pair.next.local) / way_step_;
        }
        if (!m.has_speed) m.speed = v;
        // The law takes its own spring off again.
        m.result = impact_force(m.law,
                                {.depth = m.depth,
                                 .normal = m.normal,
                                 .now = m.speed,
                                 .velocity = m.speed + step * (push - give * m.spring),
                                 .reach = m.reach,
                                 .give = give,
                                 .step = step,
                                 .beside = beside},
                                pair.history);
    });
    for (const Meeting& m : meeting) {
        Pair& pair = pair_[m.pair];
        const ImpactForce& f = m.result;
        for (ParticleId p : surface.corner(pair.point)) bears_[p] = met_[p] = 0;
        spread(surface, pair.point, f.force - m.spring, force);
        if (!f.history.touches) continue;
        const Pose& pose = now.world_from_tool[pair.tool];
        Touch& next = pair.next;
        next.speed = m.speed;
        next.dashpot = f.force - f.elastic;
        next.bond = f.bond;
        next.bound = f.bound;
        next.friction = f.friction;
        next.stored = f.stored;
        next.history = f.history;
        next.anchor = pose.inverse() * (m.place + f.reach);
        motion_energy_ += f.stored;
        LoadSum& sum = motion_load_[pair.tool];
        sum.add(m.place - pose.translation, f.force);
        sum.penetration = std::max(sum.penetration, m.depth);
        sum.sliding += f.history.slides;
    }
}

// Forces that were found at both ends of the way work on it by the trapezoid rule, as those of the
// matter do (sim/moving_body.h, stored()).
ToolLosses ContactSet::commit_motion(const Drive& now) {
    ToolLosses lost;
    for (Pair& pair : pair_) {
        const Touch &last = pair.last, &next = pair.next;
        if (last.history.touches || next.history.touches) {
            const Vec3 way = now.world_from_tool[pair.tool].turn(next.local - last.local);
            lost.damped -= 0.5 * (last.dashpot + next.dashpot).dot(way);
            lost.friction += next.friction;
            if (last.history.touches && !next.history.touches) {
                lost.damped += parting_loss(last.bound, last.bond, way / last_step_, last_step_);
            }
        }
        // What its spring held when its cell broke.
        if (pair.gone) lost.damped += next.stored;
        come_out(pair, next.depth);
        pair.history = next.history;
        pair.entry = next.history.touches ? next.entry : ToolEntry{};
        pair.anchor = next.anchor;
        pair.stuck = next.history.touches;
    }
    forget_gone();
    return lost;
}

}  // namespace swage
