// SPDX-License-Identifier: GPL-3.0-or-later
// Conservative advancement: a signed distance changes no faster than the tool moves, so a step as
// long as the smallest distance never passes the first contact (Hart, Sphere Tracing, 1996).
#include "machines/touch.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr std::size_t kPointsPerChunk = 4096;
constexpr double kStepShare = 0.95;     // of the free way: sampled distances err a little
constexpr double kSmallestStep = 1e-4;  // of the tool's and the body's size together
constexpr double kResolution = 1e-10;   // the same

}  // namespace

double nearest_distance(const Shape& shape, const Pose& points_from_tool,
                        const std::vector<Vec3>& points) {
    const Pose tool_from_points = points_from_tool.inverse();
    const auto nearest_of = [&](std::size_t begin, std::size_t end) {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t p = begin; p < end; ++p) {
            nearest = std::min(nearest, distance_to(shape, tool_from_points * points[p]).value);
        }
        return nearest;
    };
    double smallest = std::numeric_limits<double>::infinity();
    for (double value : parallel_parts(points.size(), kPointsPerChunk, nearest_of)) {
        smallest = std::min(smallest, value);
    }
    return smallest;
}

namespace {

constexpr int kHalvings = 60, kNarrowings = 100;

// Where a straight way first comes as near as `gap` to a convex shape, whose distance along it
// first falls and then rises: however thin the shape is. `room` is that distance less the gap.
template <typename Room>
std::optional<double> first_of_convex(const Room& room, double begin, double end) {
    constexpr double kGolden = 0.6180339887498949;
    double low = begin, high = end;
    double at[2] = {high - kGolden * (high - low), low + kGolden * (high - low)};
    double value[2] = {room(at[0]), room(at[1])};
    for (int n = 0; n < kNarrowings && value[0] > 0 && value[1] > 0; ++n) {
        const bool is_left = value[0] <= value[1];
        (is_left ? high : low) = at[is_left ? 1 : 0];
        at[is_left ? 1 : 0] = at[is_left ? 0 : 1], value[is_left ? 1 : 0] = value[is_left ? 0 : 1];
        const int anew = is_left ? 0 : 1;
        at[anew] = is_left ? high - kGolden * (high - low) : low + kGolden * (high - low);
        value[anew] = room(at[anew]);
    }
    if (value[0] > 0 && value[1] > 0) return std::nullopt;
    double free = begin, touching = at[value[0] <= 0 ? 0 : 1];
    if (room(free) <= 0) return free;
    for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (free + touching);
        (room(middle) > 0 ? free : touching) = middle;
    }
    return free;
}

}  // namespace

std::optional<double> slide_to_touch(const Shape& shape, const Pose& points_from_tool,
                                     const Vec3& direction, const std::vector<Vec3>& points,
                                     double gap) {
    const Box bounds = bounds_of(shape);
    const double radius = bounds.low.cwiseAbs().cwiseMax(bounds.high.cwiseAbs()).norm();
    const double reach = radius + std::max(gap, 0.0);

    // Only points in the tube that the tool's ball sweeps can be touched.
    std::vector<Vec3> in_the_way;
    double begin = std::numeric_limits<double>::infinity();
    double end = -std::numeric_limits<double>::infinity();
    for (const Vec3& point : points) {
        const Vec3 from_tool = point - points_from_tool.translation;
        const double along = direction.dot(from_tool);
        if ((from_tool - along * direction).norm() > reach) continue;
        in_the_way.push_back(point);
        begin = std::min(begin, along);
        end = std::max(end, along);
    }
    if (in_the_way.empty()) return std::nullopt;
    const double size = end - begin + 2 * reach;
    begin -= 1.001 * reach;
    end += 1.001 * reach;

    const auto room = [&](double shift) {
        Pose moved = points_from_tool;
        moved.translation += shift * direction;
        return nearest_distance(shape, moved, in_the_way) - gap;
    };
    // Steps as long as these could go through it.
    const double deepest = 0.5 * thinness_of(shape) + gap;
    if (4 * deepest < kSmallestStep * size && is_convex(shape)) {
        const auto first_of = [&](std::size_t from, std::size_t to) {
            double first = std::numeric_limits<double>::infinity();
            for (std::size_t p = from; p < to; ++p) {
                const auto one_room = [&](double shift) {
                    Pose moved = points_from_tool;
                    moved.translation += shift * direction;
                    return distance_to(shape, moved.inverse() * in_the_way[p]).value - gap;
                };
                first = std::min(first, first_of_convex(one_room, begin, end).value_or(first));
            }
            return first;
        };
        double first = std::numeric_limits<double>::infinity();
        for (double one : parallel_parts(in_the_way.size(), kPointsPerChunk, first_of)) {
            first = std::min(first, one);
        }
        if (first > end) return std::nullopt;
        return first;
    }
    double free = begin, touching = begin;
    while (touching <= end) {
        const double left = room(touching);
        if (left <= 0) break;
        free = touching;
        touching += std::max(kStepShare * left, kSmallestStep * size);
    }
    if (touching > end) return std::nullopt;
    while (touching - free > kResolution * size) {
        const double middle = 0.5 * (free + touching);
        (room(middle) > 0 ? free : touching) = middle;
    }
    return free;
}

}  // namespace swage
