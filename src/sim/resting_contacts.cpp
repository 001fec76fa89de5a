// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/resting_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.h"
#include "laws/contact.h"
#include "sim/surface_forces.h"

namespace swage {

namespace {

constexpr std::size_t kPairsPerChunk = 512, kChunksAtOnce = 16;

}  // namespace

RestingContacts::RestingContacts(const Aggregate& matter, const Apparatus& apparatus,
                                 const SimSettings& settings, int body)
    : apparatus_(&apparatus),
      pairs_(matter, apparatus, settings, body),
      grips_(matter, apparatus, settings, body),
      is_pierced_(apparatus.tool.size(), 0) {}

void RestingContacts::connections_changed(const Aggregate& matter) {
    pairs_.connections_changed(matter);
    grips_.connections_changed(matter);
}

void RestingContacts::add_stiffness(const Aggregate& matter, std::vector<double>& stiffness) const {
    pairs_.add_stiffness(stiffness);
    grips_.add_stiffness(matter, stiffness);
}

double RestingContacts::travel(const Aggregate& matter, const Drive& from, const Drive& to,
                               std::size_t every) const {
    return std::max(pairs_.travel(matter, from, to, every), grips_.travel(from, to));
}

double RestingContacts::near_travel(const Drive& from, const Drive& to) const {
    return std::max(grips_.travel(from, to), pairs_.near_travel(from, to));
}

struct RestingContacts::TouchNow {
    std::size_t pair;
    Vec3 place;
    Distance distance;
    double stiffness;  // [N/m]
    ContactForce contact;
};

// Of pairs from `begin` on those that touch, in their order.
void RestingContacts::find_touches(const Aggregate& matter, const std::vector<ToolFrame>& frame,
                                   double moved, std::size_t begin, std::size_t end,
                                   std::vector<TouchNow>& found) const {
    found.clear();
    for (std::size_t n = begin; n < end; ++n) {
        if (!pairs_.may_touch(n, moved)) continue;
        const ToolPairs::Pair& pair = pairs_[n];
        const auto& [turn, at] = frame[pair.tool];
        const Vec3 x = pairs_.place(pair, matter);
        ToolEntry entry;
        Distance d = pairs_.distance_since_start(pair, turn.transpose() * (x - at), entry);
        if (d.value >= 0) continue;
        d.normal = turn * d.normal;
        const double k = pairs_.stiffness(pair);
        const Vec3 anchor = turn * pairs_.anchor(pair) + at;
        found.push_back(
            {n, x, d, k, contact_force(d.value, d.normal, x, anchor, k, k, pairs_.friction(pair))});
    }
}

// Found on all threads, some at a time, which stay in the cache.
template <typename Act>
void RestingContacts::for_each_touch(const Aggregate& matter, const Drive& now, const Act& act,
                                     double moved) const {
    std::vector<ToolFrame> frame;
    for (const Pose& pose : now.world_from_tool) {
        frame.push_back({pose.rotation.toRotationMatrix(), pose.translation});
    }
    std::array<std::vector<TouchNow>, kChunksAtOnce> found;
    constexpr std::size_t kAtOnce = kChunksAtOnce * kPairsPerChunk;
    for (std::size_t first = 0; first < pairs_.size(); first += kAtOnce) {
        const std::size_t last = std::min(pairs_.size(), first + kAtOnce);
        const std::size_t chunks = chunks_of(last - first, kPairsPerChunk);
        parallel_for(chunks, [&](std::size_t chunk) {
            const std::size_t begin = first + chunk * kPairsPerChunk;
            find_touches(matter, frame, moved, begin, std::min(last, begin + kPairsPerChunk),
                         found[chunk]);
        });
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
            for (const TouchNow& touch : found[chunk]) act(touch);
        }
    }
}

std::vector<HeldPoint> RestingContacts::held_points(const Aggregate& matter, const Drive& now,
                                                    Slipping slipping) const {
    std::vector<HeldPoint> held;
    for_each_touch(matter, now, [&](const TouchNow& t) {
        const ToolPairs::Pair& pair = pairs_[t.pair];
        const double k = t.stiffness;
        const Vec3& normal = t.distance.normal;
        Mat3 stiffness = k * Mat3::Identity();
        const bool is_smooth = pairs_.friction(pair) == 0;  // never sticks, not even at rest
        if ((is_smooth && slipping != Slipping::stuck) ||
            (t.contact.slips && slipping == Slipping::free)) {
            stiffness = k * normal * normal.transpose();
        } else if (t.contact.slips && slipping == Slipping::lawful) {
            const Vec3 anchor = now.world_from_tool[pair.tool] * pairs_.anchor(pair);
            stiffness = contact_stiffness(t.distance.value, normal, t.place, anchor, k, k,
                                          pairs_.friction(pair));
        }
        held.push_back(held_point(pairs_.points(), pair.point, stiffness));
    });
    grips_.add_held_points(matter, now, held);
    return held;
}

void RestingContacts::add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force,
                                 double moved) const {
    const auto add = [&](const TouchNow& t) {
        spread(pairs_.points(), pairs_[t.pair].point, t.contact.force, force);
    };
    for_each_touch(matter, now, add, moved);
    grips_.add_forces(matter, now, force);
}

std::vector<PartSum> RestingContacts::loads(const Aggregate& matter, const Drive& now) const {
    std::vector<PartSum> sums(apparatus_->tool.size() + apparatus_->grip.size());
    for_each_touch(matter, now, [&](const TouchNow& t) {
        const int tool = pairs_[t.pair].tool;
        PartSum& sum = sums[tool];
        const Vec3 arm = t.place - now.world_from_tool[tool].translation;
        sum.add(arm, t.contact.force);
        sum.penetration = std::max(sum.penetration, -t.distance.value);
    });
    grips_.add_loads(matter, now, apparatus_->tool.size(), sums);
    return sums;
}

double RestingContacts::stored_energy(const Aggregate& matter, const Drive& now) const {
    double sum = 0;
    for_each_touch(matter, now, [&](const TouchNow& t) {
        // Both springs have the stiffness k: |F|^2 = N^2 + T^2.
        sum += 0.5 * t.contact.force.squaredNorm() / t.stiffness;
    });
    return sum + grips_.stored_energy(matter, now);
}

double RestingContacts::commit(const Aggregate& matter, const Drive& now) {
    std::vector<char> touches(pairs_.size(), 0);
    double lost = 0;
    for_each_touch(matter, now, [&](const TouchNow& t) {
        ToolPairs::Pair& pair = pairs_[t.pair];
        touches[t.pair] = 1;
        const Pose& pose = now.world_from_tool[pair.tool];
        const Vec3 &x = t.place, &normal = t.distance.normal;
        const Vec3 anchor = dragged_anchor(t.contact, normal, x, t.stiffness);
        if (t.contact.slips) {
            const Vec3 reach = pose * pairs_.anchor(pair) - x;
            const Vec3 held = anchor - x;  // along the force, k |held| long
            const double slipped = (reach - normal * normal.dot(reach)).norm() - held.norm();
            lost += t.stiffness * held.norm() * slipped;
        }
        pair.anchor = pose.inverse() * anchor;
    });
    for (std::size_t n = 0; n < pairs_.size(); ++n) {
        ToolPairs::Pair& pair = pairs_[n];
        ToolEntry entry;
        const Vec3 local = pairs_.local(pair, matter, now);
        const double depth = -pairs_.distance_since_start(pair, local, entry).value;
        if (!touches[n] && pair.stuck && pairs_.is_beyond(pair, local)) is_pierced_[pair.tool] = 1;
        pair.depth = touches[n] ? depth + pair.deep : 0;
        pair.come_out(depth);
        pair.entry = touches[n] ? entry : ToolEntry{};
        pair.stuck = touches[n];
    }
    pairs_.forget_gone();
    return lost;
}

std::vector<int> RestingContacts::take_pierced() {
    std::vector<int> tool;
    for (std::size_t t = 0; t < is_pierced_.size(); ++t) {
        if (std::exchange(is_pierced_[t], 0)) tool.push_back(static_cast<int>(t));
    }
    return tool;
}

std::string RestingContacts::hardest_point(const Aggregate& matter, const Drive& now) const {
    double hardest = -1;
    std::string text = "no tool in contact";
    for_each_touch(matter, now, [&](const TouchNow& t) {
        const double size = t.contact.force.norm();
        if (size <= hardest) return;
        hardest = size;
        const Vec3& x = t.place;
        text = fmt::format("hardest contact: {} at ({:.4g}, {:.4g}, {:.4g}) m with {:.3g} N",
                           pairs_.tool(pairs_[t.pair]).name, x.x(), x.y(), x.z(), hardest);
    });
    return text;
}

}  // namespace swage
