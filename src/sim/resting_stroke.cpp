// SPDX-License-Identifier: GPL-3.0-or-later
// What contact with tools takes and gives on the way from one equilibrium to the next. The
// trapezoid rule (add_work()) has it that forces change evenly over the whole way. Two kinds of
// points break that:
//
// - those that touch at one end only. They touch for a share of the way, which the gap at the other
//   end tells; their force is taken to grow from nothing, or to fall to it, evenly over that share.
//   With the whole way a tool that draws off would be paid for what it goes through the air.
//   NOTE: only where no other point of the tool touches at that other end. Where matter rolls over
//   a tool, what one point loses the next one takes over, and the sum does change evenly.
// - those that slide. Friction T stretches its spring by the way r that the tool goes
//   against the point, until it meets its limit, which changes evenly too:
//
//       T(s) = min(T_0 + s k r, L_0 + s (L_1 - L_0)),   0 <= s <= 1
//
//   With the last of it over the whole way friction would take too much where it grows, and too
//   little of a body that its tools let go.
#include <algorithm>

#include "laws/contact.h"
#include "sim/resting_contacts.h"

namespace swage {

namespace {

constexpr int kHalvings = 20;

// The share of the way at which what is outside of a tool at one end comes to its surface.
template <typename Gap>
double crossing(const Gap& gap) {
    const bool ends_inside = gap(1) < 0;
    double low = 0, high = 1;
    for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (low + high);
        ((gap(middle) < 0) == ends_inside ? high : low) = middle;
    }
    return 0.5 * (low + high);
}

// What sliding takes [J] of a spring of stiffness k under `first` that is drawn on by `way` and
// slides at the end.
double slide(double first, double way, double first_limit, double last_limit, double k) {
    const double over = k * way - (last_limit - first_limit);
    const double sticks = over > 0 ? std::clamp((first_limit - first) / over, 0.0, 1.0) : 1;
    const double turn = first + sticks * k * way;
    const double stored = (last_limit * last_limit - turn * turn) / (2 * k);
    return std::max(0.0, (1 - sticks) * way * 0.5 * (turn + last_limit) - stored);
}

Vec3 across(const Vec3& normal, const Vec3& v) { return v - normal * normal.dot(v); }

}  // namespace

RestingContacts::Stroke RestingContacts::stroke(const Aggregate& matter, const Drive& from,
                                                const Drive& to) const {
    Stroke stroke;
    stroke.idle.assign(apparatus_->tool.size() + apparatus_->grip.size(), 0.0);
    std::vector<char> touched(apparatus_->tool.size(), 0), touching(touched);
    for (const ToolPairs::Pair& pair : pairs_) touched[pair.tool] |= char(pair.stuck && !pair.gone);
    const std::vector<LoadSum> load = loads(matter, to);
    for (std::size_t t = 0; t < touching.size(); ++t) touching[t] = load[t].contacts > 0;
    for (const ToolPairs::Pair& pair : pairs_) {
        if (pair.gone) continue;
        const Pose &first = from.world_from_tool[pair.tool], &last = to.world_from_tool[pair.tool];
        const Vec3 x = pairs_.place(pair, matter);
        const Vec3& start = pairs_.start_place(pair);
        const auto distance = [&](const Pose& pose, const Vec3& at) {
            ToolEntry entry;
            const Distance d = pairs_.distance_since_start(pair, pose.inverse() * at, entry);
            return Distance{d.value, pose.turn(d.normal)};
        };
        const auto gap = [&](const Pose& pose, const Vec3& at) { return distance(pose, at).value; };
        const Distance d = distance(last, x);
        const bool touches = d.value < 0;
        if (!touches && !pair.stuck) continue;

        const double k = pairs_.stiffness(pair), friction = pairs_.friction(pair);
        const Vec3 anchor = pairs_.anchor(pair);
        const auto force_at = [&](const Distance& at, const Pose& pose, const Vec3& point) {
            return contact_force(at.value, at.normal, point, pose * anchor, k, k, friction);
        };
        const auto work_of = [&](const Vec3& force, const Pose& pose, const Vec3& point) {
            return 0.5 * force.dot(last.translation - first.translation) +
                   0.5 * (point - pose.translation).cross(force).dot(turn_between(first, last));
        };
        const ContactForce now = force_at(d, last, x);
        if (touches && pair.stuck) {
            if (!now.slips) continue;
            const Distance then_at = distance(first, start);
            const ContactForce then = force_at(then_at, first, start);
            const Vec3 reach = across(d.normal, last * anchor - x), along = reach.normalized();
            const double before = across(then_at.normal, then.force).dot(along);
            stroke.friction += slide(before, reach.norm() - before / k, friction * then.normal,
                                     friction * now.normal, k);
            continue;
        }

        // The matter moves as far as the tool bears on it: it stands until touched, and has sprung
        // back by when it is left. Where that does not part them the matter itself has come or
        // gone, and does so evenly.
        const Vec3& free = touches ? start : x;
        const bool tool_parts = touches ? gap(last, free) < 0 : gap(first, free) < 0;
        const auto place = [&](double s) {
            return tool_parts ? free : Vec3((1 - s) * start + s * x);
        };
        double share = touches ? 0 : 1;
        const bool others = touches ? touched[pair.tool] : touching[pair.tool];
        if (!others && !(touches && gap(first, start) < 0)) {
            share = crossing([&](double s) { return gap(between(first, last, s), place(s)); });
        }
        const Pose there = between(first, last, share);
        const Vec3 met = place(share);
        if (touches) {
            // What sticks at last is held from where the way began.
            const Vec3 push = now.normal * d.normal;
            stroke.idle[pair.tool] += share * work_of(now.slips ? now.force : push, last, x);
            if (!now.slips) continue;
            const double way = across(d.normal, last * (there.inverse() * met) - x).norm();
            stroke.friction += slide(0, way, 0, friction * now.normal, k);
        } else {
            const Distance then_at = distance(first, start);
            const ContactForce then = force_at(then_at, first, start);
            stroke.idle[pair.tool] += (1 - share) * work_of(then.force, first, start);
            const Vec3 drag = across(then_at.normal, then.force);
            stroke.friction += std::max(0.0, 0.5 * drag.dot(there * anchor - met));
        }
    }
    return stroke;
}

}  // namespace swage
