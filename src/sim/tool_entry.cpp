// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/tool_entry.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

constexpr int kMostSamples = 256;  // of a way

ToolEntry entry_at(const Distance& distance, const Vec3& place) {
    return {distance.normal, distance.normal.dot(place) - distance.value};
}

// Where a straight way first lies inside, in quarters of how thin the tool is.
ToolEntry met_on_the_way(const Shape& shape, const Vec3& from, const Vec3& now) {
    const double quarters = 4 * (now - from).norm() / thinness_of(shape);
    const int count = static_cast<int>(std::min<double>(kMostSamples, std::ceil(quarters)));
    for (int n = 1; n < count; ++n) {
        const Vec3 place = from + double(n) / count * (now - from);
        const Distance distance = distance_to(shape, place);
        if (distance.value < 0) return entry_at(distance, place);
    }
    return {};
}

}  // namespace

Distance distance_by_entry(const Shape& shape, const EntryReach& reach, const Vec3& from,
                           const Vec3& now, ToolEntry& entry) {
    const Distance nearest = distance_to(shape, now);
    const double thin = thinness_of(shape);
    if (thin >= 2 * reach.deep) return nearest;  // beyond its middle is too deep
    const bool is_inside = nearest.value < 0;
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
    entry = is_inside ? entry_at(nearest, now) : ToolEntry{};
    return nearest;
}

}  // namespace swage
