// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "laws/contact.h"
#include "sim/move_outcome.h"
#include "sim/surface_forces.h"
#include "sim/surface_modulus.h"

namespace swage {

namespace {

constexpr std::size_t kPointsPerChunk = 4096;
constexpr std::size_t kPairsPerChunk = 512, kChunksAtOnce = 16;
// Of a tool's distance, what is surely left to go: that of a mesh, found between the points of a
// grid, may change sqrt(3) times as fast as the place.
constexpr double kSureShare = 0.5;
// Spacings that a point beyond the middle of a tool may lie beside it, and how deep where nothing
// has a speed: what is let go of there goes round tools and through them on its way to rest.
constexpr double kBeside = 0.25, kDeepAtRest = 1;
// What points that touch may add to the square of a swing by which steps go in turns, 4.
constexpr double kTouchShare = 0.5;

// The farthest that any corner of the tool's bounds moves.
double bounds_travel(const Tool& tool, const Pose& from, const Pose& to) {
    const Box box = bounds_of(tool.shape);
    double farthest = 0;
    for (int c = 0; c < 8; ++c) {
        const Vec3 corner(c & 1 ? box.high.x() : box.low.x(), c & 2 ? box.high.y() : box.low.y(),
                          c & 4 ? box.high.z() : box.low.z());
        farthest = std::max(farthest, (to * corner - from * corner).norm());
    }
    return farthest;
}

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

ContactSet::ContactSet(const Aggregate& matter, const Apparatus& apparatus,
                       const SimSettings& settings, int body)
    : apparatus_(&apparatus),
      grips_(matter, apparatus, settings, body),
      body_(body),
      settings_(settings),
      spacing_(matter.lattice.spacing),
      pressed_modulus_(pressed_modulus(matter.material, settings.solver)),
      law_(law_on_tools(matter.material)),
      holding_(matter.material.holding_friction()),
      ratio_(law_.friction > 0 ? holding_ / law_.friction : 1),
      stickiness_(matter.material.stickiness),
      tool_way_(apparatus.tool.size()),
      motion_load_(apparatus.tool.size() + apparatus.grip.size()) {
    if (apparatus.tool.empty()) return;
    touch_ = std::make_shared<TouchPoints>(matter);
    point_modulus_ = surface_moduli(matter, points(), settings_.solver);
}

double ContactSet::point_stiffness(std::size_t point, double tool_says) const {
    const double modulus = point_modulus_.empty() ? pressed_modulus_ : point_modulus_[point];
    return settings_.stiffness_of_contacts(tool_says) * modulus * points().area(point) / spacing_;
}

double ContactSet::pair_stiffness(const Pair& pair) const {
    const double k = point_stiffness(pair.point, apparatus_->tool[pair.tool].contact_stiffness);
    return stiffness_limit_.empty() ? k : std::min(k, stiffness_limit_[pair.point]);
}

void ContactSet::limit_stiffness(const Aggregate& matter, double step) {
    limit_step_ = last_step_ = step;
    grips_.limit_stiffness(matter, step);
    if (touch_ != nullptr) find_limits(matter);
}

void ContactSet::find_limits(const Aggregate& matter) {
    std::vector<double> stiffness;
    for (std::size_t p = 0; p < points().size(); ++p) stiffness.push_back(point_stiffness(p, 0));
    stiffness_limit_ =
        stiffest_of_points(matter, points(), stiffness, kTouchShare / (limit_step_ * limit_step_));
}

void ContactSet::connections_changed(const Aggregate& matter) {
    grips_.connections_changed(matter);
    if (touch_ == nullptr) return;
    if (touch_.use_count() > 1) touch_ = std::make_shared<TouchPoints>(*touch_);  // saved states'
    const std::size_t before = touch_->size();
    touch_->connections_changed(matter);
    for (Pair& pair : pair_) pair.gone = pair.gone || !touch_->meets(pair.point);
    if (touch_->size() == before) return;
    point_modulus_ = surface_moduli(matter, points(), settings_.solver);
    if (!stiffness_limit_.empty()) find_limits(matter);
    for (std::size_t p = start_position_.size(); p < points().size(); ++p) {
        start_position_.push_back(points().position(std::size_t(p), matter.particle_position));
    }
}

void ContactSet::begin_move(const Aggregate& matter, const Drive& from) {
    tool_from_world_at_start_.clear();
    if (apparatus_->tool.empty()) return;
    start_position_.resize(points().size());
    parallel_each(start_position_.size(), kPointsPerChunk, [&](std::size_t p) {
        start_position_[p] = points().position(p, matter.particle_position);
    });
    for (const Pose& pose : from.world_from_tool)
        tool_from_world_at_start_.push_back(pose.inverse());
}

void ContactSet::find_candidates(const Aggregate& matter, const Drive& now) {
    if (touch_ == nullptr) return;
    std::vector<Pair> found;
    std::vector<double> clearances;
    const auto keep = [&](const Pair& pair) {
        found.push_back(pair);
        clearances.push_back(0);
    };
    auto old = pair_.begin();
    for (std::size_t t = 0; t < apparatus_->tool.size(); ++t) {
        const Tool& tool = apparatus_->tool[t];
        const Pose tool_from_world = now.world_from_tool[t].inverse();
        Box reach = bounds_of(tool.shape);
        reach.low.array() -= spacing_;
        reach.high.array() += spacing_;
        struct Near {
            int point;
            double clearance, distance;
        };
        // In this move, so that it touches though it is outside.
        const double thin = thinness_of(tool.shape);
        const auto may_be_through = [&](std::size_t p, const Vec3& local) {
            return p < start_position_.size() && t < tool_from_world_at_start_.size() &&
                   (local - tool_from_world_at_start_[t] * start_position_[p]).norm() >= thin;
        };
        const auto find_near = [&](std::size_t begin, std::size_t end, std::vector<Near>& near) {
            for (std::size_t p = begin; p < end; ++p) {
                if (!touch_->meets(int(p))) continue;
                const Vec3 local = tool_from_world * points().position(p, matter.particle_position);
                if ((local.array() < reach.low.array()).any() ||
                    (local.array() > reach.high.array()).any()) {
                    continue;
                }
                const double distance = distance_to(tool.shape, local).value;
                if (distance >= spacing_) continue;
                double carried = 0;  // at most, of how far its particles move
                for (double w : points().carriers(p).weight) carried += std::abs(w);
                const double sure =
                    may_be_through(p, local) ? 0 : kSureShare * distance / std::sqrt(3.0);
                near.push_back({static_cast<int>(p), sure / carried, distance});
            }
        };
        const int tool_id = static_cast<int>(t);
        for (const auto& [p, clearance, distance] :
             parallel_collect<Near>(points().size(), kPointsPerChunk, find_near)) {
            for (; old != pair_.end() && std::pair(old->tool, old->point) < std::pair(tool_id, p);
                 ++old) {
                if (old->stuck) keep(*old);
            }
            clearances.push_back(clearance);
            if (old != pair_.end() && old->tool == tool_id && old->point == p) {
                if (old->stuck) clearances.back() = 0;
                found.push_back(*old++);
            } else {
                Pair& pair = found.emplace_back(Pair{tool_id, p, false, Vec3::Zero()});
                const bool is_new_surface = static_cast<std::size_t>(p) >= touch_->own();
                if (is_new_surface) pair.deep = std::max(0.0, -distance);
                pair.last.local = pair.next.local =
                    tool_from_world * points().position(std::size_t(p), matter.particle_position);
            }
        }
    }
    for (; old != pair_.end(); ++old) {
        if (old->stuck) keep(*old);
    }
    pair_ = std::move(found);
    clearance_ = std::move(clearances);
}

void ContactSet::add_stiffness(const Aggregate& matter, std::vector<double>& stiffness) const {
    // Normal and tangential stiffness are equal, so each point pulls with k in every direction.
    for (const Pair& pair : pair_) {
        spread_stiffness(points(), pair.point, pair_stiffness(pair), stiffness);
    }
    grips_.add_stiffness(matter, stiffness);
}

std::vector<HeldPoint> ContactSet::held_points(const Aggregate& matter, const Drive& now,
                                               Slipping slipping) const {
    std::vector<HeldPoint> held;
    for_each_touch(matter, now,
                   [&](std::size_t n, const Vec3& x, const Distance& d, double k,
                       const ContactForce& contact) {
                       const Pair& pair = pair_[n];
                       Mat3 stiffness = k * Mat3::Identity();
                       if (contact.slips && slipping == Slipping::free) {
                           stiffness = k * d.normal * d.normal.transpose();
                       } else if (contact.slips && slipping == Slipping::lawful) {
                           const Vec3 anchor = now.world_from_tool[pair.tool] * anchor_of(pair);
                           stiffness =
                               contact_stiffness(d.value, d.normal, x, anchor, k, k,
                                                 apparatus_->tool[pair.tool].friction_on(body_));
                       }
                       held.push_back(held_point(points(), pair.point, stiffness));
                   });
    grips_.add_held_points(matter, now, held);
    return held;
}

Vec3 ContactSet::start_of(const Pair& pair) const {
    return tool_from_world_at_start_[pair.tool] * start_position_[pair.point];
}

Vec3 ContactSet::anchor_of(const Pair& pair) const {
    return pair.stuck ? pair.anchor : start_of(pair);
}

Distance ContactSet::distance_of(const Pair& pair, const Vec3& from, const Vec3& now,
                                 ToolEntry& entry) const {
    entry = pair.entry;
    const EntryReach reach{kBeside * spacing_, settings_.solver == Solver::quasistatic
                                                   ? kDeepAtRest * spacing_
                                                   : kAnywhere};
    Distance d = distance_by_entry(apparatus_->tool[pair.tool].shape, reach, from, now, entry);
    d.value += pair.deep;
    return d;
}

Distance ContactSet::distance_since_start(const Pair& pair, const Vec3& now,
                                          ToolEntry& entry) const {
    return distance_of(pair, pair.stuck ? now : start_of(pair), now, entry);
}

struct ContactSet::TouchNow {
    std::size_t pair;
    Vec3 place;
    Distance distance;
    double stiffness;  // [N/m]
    ContactForce contact;
};

// Of pairs from `begin` on those that touch, in their order.
void ContactSet::find_touches(const Aggregate& matter, const std::vector<ToolFrame>& frame,
                              double moved, std::size_t begin, std::size_t end,
                              std::vector<TouchNow>& found) const {
    found.clear();
    for (std::size_t n = begin; n < end; ++n) {
        const Pair& pair = pair_[n];
        if (clearance_[n] > moved || pair.gone) continue;
        const Tool& tool = apparatus_->tool[pair.tool];
        const auto& [turn, at] = frame[pair.tool];
        const Vec3 x = points().position(std::size_t(pair.point), matter.particle_position);
        ToolEntry entry;
        Distance d = distance_since_start(pair, turn.transpose() * (x - at), entry);
        if (d.value >= 0) continue;
        d.normal = turn * d.normal;
        const double k = pair_stiffness(pair);
        const Vec3 anchor = turn * anchor_of(pair) + at;
        found.push_back(
            {n, x, d, k,
             contact_force(d.value, d.normal, x, anchor, k, k, tool.friction_on(body_))});
    }
}

// Found on all threads, some at a time, which stay in the cache.
template <typename Act>
void ContactSet::for_each_touch(const Aggregate& matter, const Drive& now, const Act& act,
                                double moved) const {
    std::vector<ToolFrame> frame;
    for (const Pose& pose : now.world_from_tool) {
        frame.push_back({pose.rotation.toRotationMatrix(), pose.translation});
    }
    std::array<std::vector<TouchNow>, kChunksAtOnce> found;
    constexpr std::size_t kAtOnce = kChunksAtOnce * kPairsPerChunk;
    for (std::size_t first = 0; first < pair_.size(); first += kAtOnce) {
        const std::size_t last = std::min(pair_.size(), first + kAtOnce);
        const std::size_t chunks = chunks_of(last - first, kPairsPerChunk);
        parallel_for(chunks, [&](std::size_t chunk) {
            const std::size_t begin = first + chunk * kPairsPerChunk;
            find_touches(matter, frame, moved, begin, std::min(last, begin + kPairsPerChunk),
                         found[chunk]);
        });
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
            for (const TouchNow& t : found[chunk]) {
                act(t.pair, t.place, t.distance, t.stiffness, t.contact);
            }
        }
    }
}

void ContactSet::add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force,
                            double moved) const {
    for_each_touch(
        matter, now,
        [&](std::size_t n, const Vec3&, const Distance&, double, const ContactForce& contact) {
            spread(points(), pair_[n].point, contact.force, force);
        },
        moved);
    grips_.add_forces(matter, now, force);
}

std::vector<LoadSum> ContactSet::loads(const Aggregate& matter, const Drive& now) const {
    std::vector<LoadSum> sums(apparatus_->tool.size() + apparatus_->grip.size());
    for_each_touch(
        matter, now,
        [&](std::size_t n, const Vec3& x, const Distance& d, double, const ContactForce& contact) {
            LoadSum& sum = sums[pair_[n].tool];
            const Vec3 arm = x - now.world_from_tool[pair_[n].tool].translation;
            sum.add(arm, contact.force);
            sum.penetration = std::max(sum.penetration, -d.value);
            sum.sliding += contact.slips;
        });
    grips_.add_loads(matter, now, apparatus_->tool.size(), sums);
    return sums;
}

double ContactSet::stored_energy(const Aggregate& matter, const Drive& now) const {
    double sum = 0;
    for_each_touch(
        matter, now,
        [&](std::size_t, const Vec3&, const Distance&, double k, const ContactForce& contact) {
            // Both springs have the stiffness k: |F|^2 = N^2 + T^2.
            sum += 0.5 * contact.force.squaredNorm() / k;
        });
    return sum + grips_.stored_energy(matter, now);
}

double ContactSet::commit(const Aggregate& matter, const Drive& now) {
    std::vector<char> touches(pair_.size(), 0);
    double lost = 0;
    for_each_touch(matter, now,
                   [&](std::size_t n, const Vec3& x, const Distance& d, double k,
                       const ContactForce& contact) {
                       Pair& pair = pair_[n];
                       touches[n] = 1;
                       const Pose& pose = now.world_from_tool[pair.tool];
                       const Vec3 anchor = dragged_anchor(contact, d.normal, x, k);
                       if (contact.slips) {
                           const Vec3 reach = pose * anchor_of(pair) - x;
                           const Vec3 held = anchor - x;  // along the force, k |held| long
                           const double slipped =
                               (reach - d.normal * d.normal.dot(reach)).norm() - held.norm();
                           lost += k * held.norm() * slipped;
                       }
                       pair.anchor = pose.inverse() * anchor;
                   });
    // Explicit steps that may follow find what rests.
    for (std::size_t n = 0; n < pair_.size(); ++n) {
        Pair& pair = pair_[n];
        const Vec3 x = points().position(std::size_t(pair.point), matter.particle_position);
        const Vec3 local = now.world_from_tool[pair.tool].inverse() * x;
        ToolEntry entry;
        come_out(pair, -distance_since_start(pair, local, entry).value);
        pair.entry = touches[n] ? entry : ToolEntry{};
        pair.stuck = touches[n];
        pair.history = {.touches = pair.stuck, .rests = pair.stuck};
        pair.next = {.local = local, .history = pair.history, .anchor = pair.anchor};
        pair.last = pair.next;
    }
    forget_gone();
    return lost;
}

void ContactSet::come_out(Pair& pair, double depth) {
    pair.deep = std::clamp(depth + pair.deep, 0.0, pair.deep);
}

void ContactSet::forget_gone() {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < pair_.size(); ++n) {
        if (pair_[n].gone) continue;
        clearance_[kept] = clearance_[n];
        pair_[kept++] = pair_[n];
    }
    clearance_.resize(kept);
    pair_.erase(pair_.begin() + std::ptrdiff_t(kept), pair_.end());
}

double ContactSet::travel(const Aggregate& matter, const Drive& from, const Drive& to) const {
    double farthest = 0;
    for (std::size_t t = 0; t < apparatus_->tool.size(); ++t) {
        const Tool& tool = apparatus_->tool[t];
        const double most = bounds_travel(tool, from.world_from_tool[t], to.world_from_tool[t]);
        if (most <= spacing_) {
            farthest = std::max(farthest, most);
            continue;
        }
        const Pose tool_from_world = from.world_from_tool[t].inverse();
        for (std::size_t p = 0; p < points().size(); ++p) {
            if (!touch_->meets(int(p))) continue;
            const Vec3 x = points().position(std::size_t(p), matter.particle_position);
            const Vec3 local = tool_from_world * x;
            if (distance_to(tool.shape, local).value > most + 2 * spacing_) continue;
            farthest = std::max(farthest, (to.world_from_tool[t] * local - x).norm());
        }
    }
    return std::max(farthest, grips_.travel(from, to));
}

double ContactSet::near_travel(const Drive& from, const Drive& to) const {
    double farthest = grips_.travel(from, to);
    for (std::size_t t = 0; t < apparatus_->tool.size(); ++t) {
        const int tool = static_cast<int>(t);
        const bool is_near =
            std::binary_search(pair_.begin(), pair_.end(), Pair{tool, 0, false, {}},
                               [](const Pair& a, const Pair& b) { return a.tool < b.tool; });
        if (is_near) {
            const double own =
                bounds_travel(apparatus_->tool[t], from.world_from_tool[t], to.world_from_tool[t]);
            farthest = std::max(farthest, own);
        }
    }
    return farthest;
}

std::string ContactSet::hardest_point(const Aggregate& matter, const Drive& now) const {
    double hardest = -1;
    std::string text = "no tool in contact";
    for_each_touch(
        matter, now,
        [&](std::size_t n, const Vec3& x, const Distance&, double, const ContactForce& contact) {
            if (contact.force.norm() <= hardest) return;
            hardest = contact.force.norm();
            text = fmt::format("hardest contact: {} at ({:.4g}, {:.4g}, {:.4g}) m with {:.3g} N",
                               apparatus_->tool[pair_[n].tool].name, x.x(), x.y(), x.z(), hardest);
        });
    return text;
}

void add_work(const Drive& from, const Drive& to, const std::vector<LoadSum>& before,
              const std::vector<LoadSum>& after, std::vector<double>& work) {
    const std::size_t tools = from.world_from_tool.size();
    for (std::size_t n = 0; n < work.size(); ++n) {
        const Pose& a = n < tools ? from.world_from_tool[n] : from.world_from_grip[n - tools];
        const Pose& b = n < tools ? to.world_from_tool[n] : to.world_from_grip[n - tools];
        work[n] += 0.5 * (before[n].force + after[n].force).dot(b.translation - a.translation) +
                   0.5 * (before[n].torque + after[n].torque).dot(turn_between(a, b));
    }
}

}  // namespace swage
