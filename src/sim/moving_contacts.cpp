// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/moving_contacts.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "sim/surface_forces.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;  // points

// Tools are rigid, so that all of the give is the matter's.
ImpactLaw law_on_tools(const Material& material) {
    const double e = material.restitution;
    ImpactLaw law{};
    law.restitution = e;
    law.loss = restitution_loss(e);
    law.damping = restitution_damping(e);
    law.friction = material.friction;
    return law;
}

}  // namespace

MovingContacts::MovingContacts(const Aggregate& matter, const Apparatus& apparatus,
                               const SimSettings& settings, int body)
    : apparatus_(&apparatus),
      settings_(settings),
      body_(body),
      rest_(matter, apparatus, settings, body),
      law_(law_on_tools(matter.material)),
      holding_(matter.material.holding_friction()),
      ratio_(law_.friction > 0 ? holding_ / law_.friction : 1),
      stickiness_(matter.material.stickiness),
      tool_way_(apparatus.tool.size()),
      load_(apparatus.tool.size() + apparatus.grip.size()) {
    find_thin(matter);
}

// Those that are as they were go on.
double MovingContacts::find_thin(const Aggregate& matter) {
    if (apparatus_->tool.empty() || !follows_all_motion(settings_.solver)) return 0;
    std::map<ParticleId, std::size_t> known;  // by the first particle, which is no other's
    for (std::size_t n = 0; n < thin_.size(); ++n) known[thin_[n].piece->particles()[0]] = n;
    std::vector<Thin> found;
    std::vector<ParticleId> all;
    std::optional<ThinNear> near;
    std::shared_ptr<const RestSurface> molded;
    std::shared_ptr<const Apparatus> tools;
    for (const std::vector<ParticleId>& one : thin_pieces(matter)) {
        const auto was = known.find(one[0]);
        if (was != known.end() && thin_[was->second].piece->particles() == one) {
            found.push_back(std::move(thin_[was->second]));
        } else {
            if (!molded) molded = std::make_shared<const RestSurface>(matter);
            if (!near) near.emplace(matter);
            std::shared_ptr<ThinPiece> piece = ThinPiece::find(matter, *molded, *near, one);
            if (!piece) continue;
            if (!tools) {
                Apparatus own;
                own.name = apparatus_->name;
                own.tool = apparatus_->tool;
                tools = std::make_shared<const Apparatus>(std::move(own));
            }
            found.push_back({piece, tools, {piece->matter(), *tools, settings_, body_}});
            MovingContacts& contacts = found.back().contacts;
            contacts.rest_.pairs().begin_as_new();
            if (last_step_ > 0) contacts.limit_stiffness(piece->matter(), last_step_);
        }
        all.insert(all.end(), one.begin(), one.end());
    }
    double let_go = 0;
    for (const Thin& thin : thin_) let_go += thin.piece ? thin.contacts.stored_energy() : 0;
    if (!all.empty() || !thin_.empty()) rest_.pairs().leave_out(std::move(all));
    thin_ = std::move(found);
    return let_go;
}

void MovingContacts::add_thin(const Drive& now, double step, const Vec3& gravity,
                              Vec3Array& force) {
    for (Thin& thin : thin_) {
        ThinPiece& piece = *thin.piece;
        piece.follow();
        Vec3Array& own = piece.begin_forces(force);
        thin.contacts.add_forces(piece.matter(), now, step, gravity, own);
        ContactSums unused;
        piece.end_forces(gravity, step, force, unused);
        stored_ += thin.contacts.stored_;
        for (std::size_t t = 0; t < thin.contacts.load_.size(); ++t) {
            load_[t].join(thin.contacts.load_[t]);
        }
    }
}

double MovingContacts::travel(const Aggregate& matter, const Drive& from, const Drive& to) const {
    double farthest = rest_.travel(matter, from, to);
    for (const Thin& thin : thin_) {
        farthest = std::max(farthest, thin.contacts.travel(thin.piece->matter(), from, to));
    }
    return farthest;
}

double MovingContacts::near_travel(const Drive& from, const Drive& to) const {
    double farthest = rest_.near_travel(from, to);
    for (const Thin& thin : thin_) {
        farthest = std::max(farthest, thin.contacts.near_travel(from, to));
    }
    return farthest;
}

void MovingContacts::limit_stiffness(const Aggregate& matter, double step) {
    for (Thin& thin : thin_) thin.contacts.limit_stiffness(thin.piece->matter(), step);
    last_step_ = step;
    rest_.grips().limit_stiffness(matter, step);
    rest_.pairs().limit_stiffness(matter, step);
}

double MovingContacts::connections_changed(const Aggregate& matter, const Drive& now) {
    const ToolPairs& pairs = rest_.pairs();
    double held = find_thin(matter) + rest_.grips().stored_energy(matter, now);
    std::vector<Vec3> place;
    std::vector<double> stiffness;
    for (const ToolPairs::Pair& pair : pairs) {
        place.push_back(pairs.place(pair, matter));
        stiffness.push_back(pairs.stiffness(pair));
    }
    rest_.connections_changed(matter);
    held -= rest_.grips().stored_energy(matter, now);
    for (std::size_t n = 0; n < memory_.size(); ++n) {
        Touch& next = memory_[n].next;
        if (pairs[n].gone) {
            held += std::exchange(next.stored, 0);
            continue;
        }
        const Vec3 x = pairs.place(pairs[n], matter);
        const double was = next.depth;
        if (x != place[n]) {
            const Pose tool_from_world = now.world_from_tool[pairs[n].tool].inverse();
            carry(n, tool_from_world * place[n], tool_from_world * x);
        }
        const double k = pairs.stiffness(pairs[n]);
        if (!next.history.touches || (k == stiffness[n] && next.depth == was)) continue;
        const double hold = stickiness_ * pairs.points().area(pairs[n].point);
        const Vec3 reach = next.anchor - next.local;
        const double less = spring_energy(stiffness[n], was, hold) -
                            spring_energy(k, next.depth, hold) +
                            0.5 * (stiffness[n] - k) * reach.squaredNorm();
        next.stored -= less;
        held += less;
    }
    return held;
}

// Another cell carries the point from now on, by which it lies elsewhere in the tool's frame: that
// is no way that it has gone, and what makes it deeper has not been pressed in.
void MovingContacts::carry(std::size_t n, const Vec3& from, const Vec3& to) {
    ToolPairs& pairs = rest_.pairs();
    ToolPairs::Pair& pair = pairs[n];
    Touch& next = memory_[n].next;
    const auto depth_at = [&](const Vec3& local) {
        ToolEntry entry;
        return -pairs.distance(pair, local, local, entry).value;
    };
    const double was = depth_at(from), depth = depth_at(to);
    for (Vec3* at : {&memory_[n].last.local, &next.local, &next.anchor, &pair.anchor}) {
        *at += to - from;
    }
    pair.deep += std::max(0.0, depth - std::max(was, 0.0));
    if (depth < was) next.depth = depth;
}

void MovingContacts::find_candidates(const Aggregate& matter, const Drive& now) {
    for (Thin& thin : thin_) {
        thin.piece->follow();
        thin.contacts.find_candidates(thin.piece->matter(), now);
    }
    ToolPairs& pairs = rest_.pairs();
    const std::vector<int> before = pairs.find_candidates(matter, now);
    std::vector<Memory> memory(before.size());
    for (std::size_t n = 0; n < memory.size(); ++n) {
        if (before[n] >= 0) {
            memory[n] = memory_[before[n]];
        } else {
            memory[n].last.local = memory[n].next.local = pairs.local(pairs[n], matter, now);
        }
    }
    memory_ = std::move(memory);
}

// Explicit steps that may follow find what rests.
double MovingContacts::commit_implicit_step(const Aggregate& matter, const Drive& now) {
    const double lost = rest_.commit(matter, now);
    const ToolPairs& pairs = rest_.pairs();
    memory_.resize(pairs.size());
    for (std::size_t n = 0; n < memory_.size(); ++n) {
        const ToolPairs::Pair& pair = pairs[n];
        const ImpactHistory history{.touches = pair.stuck, .rests = pair.stuck};
        const Touch touch{
            .local = pairs.local(pair, matter, now), .history = history, .anchor = pair.anchor};
        memory_[n] = {history, touch, touch};
    }
    return lost;
}

// A point that touches, or is still held.
struct MovingContacts::Meeting {
    std::size_t pair;
    bool is_found;  // `result` is, as of the last time
    double depth;
    Vec3 place, normal;
    Vec3 reach;   // to where it sticks
    Vec3 spring;  // force that it would have without a speed [N]
    ImpactLaw law;
    ImpactForce result;
};

void MovingContacts::begin_step(const Drive& from) {
    for (Thin& thin : thin_) thin.contacts.begin_step(from);
    world_from_tool_at_start_ = from.world_from_tool;
    for (std::size_t n = 0; n < memory_.size(); ++n) {
        Memory& memory = memory_[n];
        memory.last = memory.next;
        if (rest_.pairs()[n].gone) memory.next.friction = 0;  // taken by the step before
    }
}

std::vector<MovingContacts::Meeting> MovingContacts::find_meetings(const Aggregate& matter,
                                                                   const Drive& now, bool anew) {
    const ToolPairs& pairs = rest_.pairs();
    std::vector<Pose> tool_from_world;
    for (const Pose& pose : now.world_from_tool) tool_from_world.push_back(pose.inverse());
    const auto find = [&](std::size_t begin, std::size_t end, std::vector<Meeting>& met) {
        for (std::size_t n = begin; n < end; ++n) {
            const ToolPairs::Pair& pair = pairs[n];
            if (pair.gone) continue;
            const ImpactHistory& history = memory_[n].history;
            Touch& next = memory_[n].next;
            const Pose& pose = now.world_from_tool[pair.tool];
            const Vec3 x = pairs.place(pair, matter);
            const Touch found = next;
            next = {.local = tool_from_world[pair.tool] * x};
            const double hold = stickiness_ * pairs.points().area(pair.point);
            const Distance d = pairs.distance(pair, memory_[n].last.local, next.local, next.entry);
            next.depth = -d.value;
            if (d.value >= 0 && !(history.touches && hold > 0)) continue;
            Meeting m;
            m.pair = n;
            m.is_found = anew && found.history.touches;
            m.depth = -d.value;
            m.place = x;
            m.normal = pose.turn(d.normal);
            m.law = law_;
            m.law.stiffness = pairs.stiffness(pair);
            const double friction = pairs.friction(pair);
            m.law.friction = friction;
            m.law.holding = friction == law_.friction ? holding_ : ratio_ * friction;
            m.law.hold = hold;
            const double k = m.law.stiffness;
            if (d.value >= 0 && !is_bound(k, m.depth, hold)) continue;  // torn off
            // Speeds of explicit steps stand half a step before the forces; where these are found
            // anew, at the start of a frame, they have moved on.
            if (m.is_found) {
                m.result = impact_as_found(k, m.depth, hold, m.normal, pose * found.anchor - x,
                                           found.dashpot, found.bond);
                m.result.bound = found.bound;
                m.result.friction = found.friction;
                m.result.history = found.history;
                m.spring = m.result.elastic;
                met.push_back(m);
                continue;
            }
            const double N = spring_push(k, m.depth, hold), bears = N + hold;
            const Vec3 way = history.touches ? Vec3(pose * pair.anchor - x) : Vec3::Zero();
            m.reach = way - m.normal * m.normal.dot(way);
            const double limit = (history.slides ? m.law.friction : m.law.holding) * bears / k;
            const double size = m.reach.norm();
            m.spring = N * m.normal + k * std::min(1.0, size > 0 ? limit / size : 1.0) * m.reach;
            met.push_back(m);
        }
    };
    return parallel_collect<Meeting>(pairs.size(), kChunk, find);
}

void MovingContacts::add_forces(const Aggregate& matter, const Drive& now, double step,
                                const Vec3& gravity, Vec3Array& force) {
    if (step > 0) {
        last_step_ = way_step_ = step;
        for (std::size_t t = 0; t < tool_way_.size(); ++t) {
            tool_way_[t] = {world_from_tool_at_start_[t], now.world_from_tool[t]};
        }
    }
    load_.assign(load_.size(), {});
    stored_ = rest_.grips().add_all(matter, now, force, tool_way_.size(), load_);
    if (!rest_.pairs().empty()) meet(matter, now, step == 0, gravity, force);
    add_thin(now, step, gravity, force);
}

void MovingContacts::meet(const Aggregate& matter, const Drive& now, bool anew, const Vec3& gravity,
                          Vec3Array& force) {
    std::vector<Meeting> meeting = find_meetings(matter, now, anew);
    if (meeting.empty()) return;
    const double step = last_step_;
    const ToolPairs& pairs = rest_.pairs();
    const SurfacePoints& surface = pairs.points();
    bears_.resize(matter.particle_count(), 0.0);
    for (const Meeting& m : meeting) {
        const int point = pairs[m.pair].point;
        spread(surface, point, m.spring, force);
        const SurfacePoints::Carriers by = surface.carriers(static_cast<std::size_t>(point));
        for (int c = 0; c < 8; ++c) {
            bears_[by.corner[c]] += std::abs(by.weight[c]) * m.law.stiffness;
        }
    }
    met_speed_.resize(matter.particle_count(), 0.0);
    const bool is_met = std::any_of(meeting.begin(), meeting.end(), [&](const Meeting& m) {
        return !memory_[m.pair].history.touches;
    });
    for (const Meeting& m : meeting) {
        const ImpactHistory& history = memory_[m.pair].history;
        if (!is_met || !history.touches || history.rests) continue;
        for (ParticleId p : surface.corner(pairs[m.pair].point)) {
            met_speed_[p] = std::max(met_speed_[p], history.speed);
        }
    }
    parallel_each(meeting.size(), kChunk, [&](std::size_t n) {
        Meeting& m = meeting[n];
        if (m.is_found) return;
        const ToolPairs::Pair& pair = pairs[m.pair];
        const Memory& memory = memory_[m.pair];
        Vec3 v = Vec3::Zero(), push = gravity;
        double give = 0, beside = 0;  // give: S
        const auto by = surface.carriers(static_cast<std::size_t>(pair.point));
        for (int c = 0; c < 8; ++c) {
            beside = std::max(beside, met_speed_[by.corner[c]]);
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
            v -= (way.to * memory.next.local - way.from * memory.next.local) / way_step_;
        }
        // The law takes its own spring off again.
        m.result = impact_force(m.law,
                                {.depth = m.depth,
                                 .normal = m.normal,
                                 .now = v,
                                 .velocity = v + step * (push - give * m.spring),
                                 .reach = m.reach,
                                 .give = give,
                                 .step = step,
                                 .beside = beside},
                                memory.history);
    });
    for (const Meeting& m : meeting) {
        const ToolPairs::Pair& pair = pairs[m.pair];
        const ImpactForce& f = m.result;
        for (ParticleId p : surface.corner(pair.point)) bears_[p] = met_speed_[p] = 0;
        spread(surface, pair.point, f.force - m.spring, force);
        if (!f.history.touches) continue;
        const Pose& pose = now.world_from_tool[pair.tool];
        Touch& next = memory_[m.pair].next;
        next.dashpot = f.force - f.elastic;
        next.bond = f.bond;
        next.bound = f.bound;
        next.friction = f.friction;
        next.stored = f.stored;
        next.history = f.history;
        next.anchor = pose.inverse() * (m.place + f.reach);
        stored_ += f.stored;
        PartSum& sum = load_[pair.tool];
        sum.add(m.place - pose.translation, f.force);
        sum.penetration = std::max(sum.penetration, m.depth);
    }
}

// Forces that were found at both ends of the way work on it by the trapezoid rule, as those of the
// matter do (sim/moving_body.h, stored()).
ToolLosses MovingContacts::commit(const Drive& now) {
    ToolLosses lost;
    ToolPairs& pairs = rest_.pairs();
    std::size_t kept = 0;
    for (std::size_t n = 0; n < memory_.size(); ++n) {
        ToolPairs::Pair& pair = pairs[n];
        Memory& memory = memory_[n];
        const Touch &last = memory.last, &next = memory.next;
        if (last.history.touches || next.history.touches) {
            const Vec3 way = now.world_from_tool[pair.tool].turn(next.local - last.local);
            lost.damped -= 0.5 * (last.dashpot + next.dashpot).dot(way);
            lost.friction += next.friction;
            if (last.history.touches && !next.history.touches) {
                lost.damped += parting_loss(last.bound, last.bond, way / last_step_, last_step_);
            }
        }
        pair.come_out(next.depth);
        memory.history = next.history;
        pair.entry = next.history.touches ? next.entry : ToolEntry{};
        pair.anchor = next.anchor;
        pair.stuck = next.history.touches;
        if (!pair.gone) memory_[kept++] = memory;
    }
    memory_.resize(kept);
    pairs.forget_gone();
    for (Thin& thin : thin_) {
        const ToolLosses own = thin.contacts.commit(now);
        lost.damped += own.damped;
        lost.friction += own.friction;
    }
    return lost;
}

}  // namespace swage
