// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/tool_entry.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

constexpr int kMostEven = 256, kMostSteps = 1024;  // of a way

ToolEntry entry_at(const Distance& distance, const Vec3& place) {
    return {distance.normal, distance.normal.dot(place) - distance.value};
}

// Where a straight way first lies inside, in the half of the tool that it came in by: in quarters
// of how thin the tool is, and where these are too many no nearer to each other than the tool is
// far.
ToolEntry met_on_the_way(const Shape& shape, const Vec3& from, const Vec3& now) {
    const Vec3 way = now - from;
    const double length = way.norm(), quarter = 0.25 * thinness_of(shape);
    const bool is_long = length / quarter > kMostEven;
    const int count = std::max(1, static_cast<int>(std::ceil(is_long ? 1 : length / quarter)));
    const auto step_from = [&](const Vec3& place) {
        return std::max(quarter, kSureShare * distance_to(shape, place).value) / length;
    };
    double share = is_long ? step_from(from) : 1.0 / count;
    for (int n = 1; n < kMostSteps && share < 1; ++n) {
        const Vec3 place = from + share * way;
        const Distance distance = distance_to(shape, place);
        if (distance.value < 0) return entry_at(distance, place);
        share = is_long ? share + step_from(place) : double(n + 1) / count;
    }
    return {};
}

}  // namespace

Distance distance_by_entry(const Shape& shape, const EntryReach& reach, const Vec3& from,
                           const Vec3& now, ToolEntry& entry) {
    const Distance nearest = distance_to(shape, now);
    const double thin = thinness_of(shape);
    const bool is_inside = nearest.value < 0;
    const auto by_nearest = [&] {
        entry = is_inside ? entry_at(nearest, now) : ToolEntry{};
        return nearest;
    };
    if (thin >= 2 * reach.deep) return by_nearest();  // beyond its middle is too deep
    bool goes_on = nearest.normal.dot(entry.normal) >= 0;
    if (entry.normal.isZero(0)) {
        // On its way in, or on no way through: outside, less than the tool is thin.
        const Vec3 way = now - from;
        goes_on = is_inside ? way.dot(nearest.normal) <= 0 : way.norm() < thin;
        if (!goes_on) entry = met_on_the_way(shape, from, now);
        // Out again on the side where it came in, as past a bend of the surface, it is not through.
        goes_on = goes_on || nearest.normal.dot(entry.normal) >= 0;
    }
    if (!goes_on) {
        const double depth = entry.normal.dot(now) - entry.offset;
        const Vec3 foot = now - depth * entry.normal;
        if (depth < 0 && depth > -reach.deep && distance_to(shape, foot).value < reach.beside) {
            return {depth, entry.normal};
        }
    }
    return by_nearest();
}

bool is_beyond(const Shape& shape, const EntryReach& reach, const Vec3& now,
               const ToolEntry& entry) {
    const Distance nearest = distance_to(shape, now);
    if (entry.normal.isZero(0) || nearest.normal.dot(entry.normal) >= 0) return false;
    const double depth = entry.normal.dot(now) - entry.offset;
    return depth <= -reach.deep &&
           distance_to(shape, now - depth * entry.normal).value < reach.beside;
}

}  // namespace swage
