// SPDX-License-Identifier: GPL-3.0-or-later
// What contact with tools takes and gives on the way from one equilibrium to the next. The
// trapezoid rule (add_work()) has it that the force of a tool changes evenly over all of the way.
// Where points come and leave it does not: as a plate rises from what springs back they leave it
// one by one, and most of its force is gone long before the last of them. But whatever the order,
// matter that is elastic and linear gets from forces f that grow from f_0 to f_1 at points that
// move by u
//
//     W = 1/2 sum (f_0 + f_1) . u
//
// (Clapeyron, Betti). So the matter's way counts, not the tool's: what a point stores and what
// friction takes of it come on top, and for points that touch at both ends that is the trapezoid
// rule again.
// NOTE: at tools that stand, too, points come and leave as the matter bends: what the sum has of
// them is done by those that move.
//
// Friction T stretches the spring of a point that slides by the way r that the tool goes against
// it, until it meets its limit, which changes evenly:
//
//     T(s) = min(T_0 + s k r, L_0 + s (L_1 - L_0)),   0 <= s <= 1
//
// With the last of it over the whole way friction would take too much where it grows, and too
// little of a body that its tools let go. What touches at one end only slides for a share of the
// way, which the gap at the other end tells.
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

// A point and a tool on the way.
struct Way {
    const ToolPairs& pairs;
    const ToolPairs::Pair& pair;
    const Pose &first, &last;
    const Vec3 &start, x;
    const double k = pairs.stiffness(pair), friction = pairs.friction(pair);
    const Vec3 anchor = pairs.anchor(pair);
    const Distance before = distance(first, start), after = distance(last, x);
    const ContactForce then = pair.stuck ? force(before, first, start) : ContactForce{};
    const ContactForce now = force(after, last, x);

    bool touches() const { return after.value < 0; }
    bool at_one_end() const { return touches() != pair.stuck; }

    Distance distance(const Pose& pose, const Vec3& at) const {
        ToolEntry entry;
        const Distance d = pairs.distance_since_start(pair, pose.inverse() * at, entry);
        return {d.value, pose.turn(d.normal)};
    }
    double gap(const Pose& pose, const Vec3& at) const { return distance(pose, at).value; }
    ContactForce force(const Distance& at, const Pose& pose, const Vec3& point) const {
        return contact_force(at.value, at.normal, point, pose * anchor, k, k, friction);
    }
    // What the trapezoid rule has of the force at one of the ends.
    double counted(const Vec3& force, const Pose& pose, const Vec3& point) const {
        return 0.5 * force.dot(last.translation - first.translation) +
               0.5 * (point - pose.translation).cross(force).dot(turn_between(first, last));
    }
    double counted() const {
        return counted(then.force, first, start) + counted(now.force, last, x);
    }
    // What the matter gets, and the springs of contact.
    double given() const {
        return 0.5 * (then.force + now.force).dot(x - start) +
               0.5 / k * (now.force.squaredNorm() - then.force.squaredNorm());
    }
};

std::vector<Way> ways_of(const ToolPairs& pairs, const Aggregate& matter, const Drive& from,
                         const Drive& to) {
    std::vector<Way> ways;
    for (const ToolPairs::Pair& pair : pairs) {
        if (pair.gone) continue;
        const Way way{pairs,
                      pair,
                      from.world_from_tool[pair.tool],
                      to.world_from_tool[pair.tool],
                      pairs.start_place(pair),
                      pairs.place(pair, matter)};
        if (pair.stuck || way.touches()) ways.push_back(way);
    }
    return ways;
}

// How hard a tool presses at both ends of the way, and of that what touches at one end only [N].
struct Pressing {
    double before = 0, after = 0, leaves = 0, comes = 0;

    void add(const Way& way) {
        before += way.then.normal;
        after += way.now.normal;
        if (!way.pair.stuck) comes += way.now.normal;
        if (!way.touches()) leaves += way.then.normal;
    }
    // The share of what comes, or leaves, that no other point has had before or takes over.
    double alone(bool coming) const {
        const double more = coming ? after - before : before - after;
        const double all = coming ? comes : leaves;
        return all > 0 ? std::clamp(more / all, 0.0, 1.0) : 0;
    }
};

// Where what touches at one end only meets the tool, or leaves it. The matter moves as far as the
// tool bears on it: it stands until touched, and has sprung back by when it is left. Where that
// does not part them the matter itself has come or gone, and does so evenly.
struct Meeting {
    double share;
    Pose tool;
    Vec3 place;
};

Meeting meeting(const Way& way, double alone) {
    const bool comes = way.touches();
    const Vec3& free = comes ? way.start : way.x;
    const bool tool_parts = way.gap(comes ? way.last : way.first, free) < 0;
    const auto place = [&](double s) {
        return tool_parts ? free : Vec3((1 - s) * way.start + s * way.x);
    };
    const double whole = comes ? 0 : 1;
    double share = whole;
    if (alone > 0 && (!comes || way.gap(way.first, way.start) >= 0)) {
        share =
            crossing([&](double s) { return way.gap(between(way.first, way.last, s), place(s)); });
        share = whole + alone * (share - whole);
    }
    return {share, between(way.first, way.last, share), place(share)};
}

// What friction takes [J]; `alone`: of what comes or leaves.
double taken_by_friction(const Way& way, double alone) {
    const Vec3& normal = way.after.normal;
    const double k = way.k, limit = way.friction * way.now.normal;
    if (!way.touches()) {
        const Meeting left = meeting(way, alone);
        const Vec3 drag = across(way.before.normal, way.then.force);
        return std::max(0.0, 0.5 * drag.dot(left.tool * way.anchor - left.place));
    }
    if (!way.now.slips) return 0;
    if (!way.pair.stuck) {
        const Meeting met = meeting(way, alone);
        const Vec3 reach = way.last * (met.tool.inverse() * met.place) - way.x;
        return slide(0, across(normal, reach).norm(), 0, limit, k);
    }
    const Vec3 reach = across(normal, way.last * way.anchor - way.x), along = reach.normalized();
    const double drawn = across(way.before.normal, way.then.force).dot(along);
    return slide(drawn, reach.norm() - drawn / k, way.friction * way.then.normal, limit, k);
}

}  // namespace

RestingContacts::Stroke RestingContacts::stroke(const Aggregate& matter, const Drive& from,
                                                const Drive& to) const {
    Stroke stroke;
    stroke.idle.assign(apparatus_->tool.size() + apparatus_->grip.size(), 0.0);
    const std::vector<Way> ways = ways_of(pairs_, matter, from, to);
    std::vector<Pressing> pressing(apparatus_->tool.size());
    for (const Way& way : ways) pressing[way.pair.tool].add(way);
    for (const Way& way : ways) {
        const int tool = way.pair.tool;
        const double taken = taken_by_friction(way, pressing[tool].alone(way.touches()));
        stroke.friction += taken;
        stroke.idle[tool] += way.counted() - way.given() - taken;
    }
    return stroke;
}

double RestingContacts::air(const Aggregate& matter, const Drive& from, const Drive& to) const {
    std::vector<char> touched(apparatus_->tool.size(), 0), touching(touched);
    for (const ToolPairs::Pair& pair : pairs_) touched[pair.tool] |= char(pair.stuck && !pair.gone);
    const std::vector<PartSum> load = loads(matter, to);
    for (std::size_t t = 0; t < touching.size(); ++t) touching[t] = load[t].contacts > 0;
    double sum = 0;
    for (const Way& way : ways_of(pairs_, matter, from, to)) {
        const bool comes = way.touches();
        if (!way.at_one_end() || (comes ? touched : touching)[way.pair.tool]) continue;
        const double share = meeting(way, 1).share;
        if (comes) {
            // What sticks at last is held from where the way began.
            const Vec3 push = way.now.normal * way.after.normal;
            sum += share * way.counted(way.now.slips ? way.now.force : push, way.last, way.x);
        } else {
            sum += (1 - share) * way.counted(way.then.force, way.first, way.start);
        }
    }
    return sum;
}

}  // namespace swage
