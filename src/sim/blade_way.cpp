// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/blade_way.h"

#include <algorithm>
#include <array>

#include "geometry/box.h"
#include "sim/sever.h"

namespace swage {

namespace {

Vec3 mean_velocity(const Aggregate& matter) {
    Vec3 momentum = Vec3::Zero();
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        momentum += matter.particle_mass[p] * matter.particle_velocity.at(p);
    }
    return momentum / matter.mass();
}

Vec3 middle_of_edge(const Blade& blade) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& point : blade.edge) sum += point;
    return sum / static_cast<double>(blade.edge.size());
}

}  // namespace

std::vector<Drive> way_in_flight(const Aggregate& matter, const Apparatus& apparatus,
                                 std::span<const Drive> way, const Vec3& gravity) {
    std::vector<Drive> met(way.begin(), way.end());
    std::vector<Vec3> flown(way.size(), Vec3::Zero());  // on the way to each drive
    Vec3 velocity = mean_velocity(matter);
    for (std::size_t n = 1; n < way.size(); ++n) {
        const double time = way[n].time - way[n - 1].time;
        const double strength = 0.5 * (way[n - 1].gravity_strength + way[n].gravity_strength);
        const Vec3 gained = strength * time * gravity;
        flown[n] = time * (velocity + 0.5 * gained);
        velocity += gained;
    }
    for (std::size_t b = 0; b < apparatus.blade.size(); ++b) {
        Vec3 farther = Vec3::Zero();
        for (std::size_t n = 1; n < way.size(); ++n) {
            const Vec3 goes = way_between(apparatus.blade[b], way[n - 1].world_from_blade[b],
                                          way[n].world_from_blade[b]);
            const double length = goes.norm();
            if (length > 0) {
                const Vec3 along = goes / length;
                farther += std::max(0.0, -flown[n].dot(along)) * along;
            }
            met[n].world_from_blade[b].translation += farther;
        }
    }
    return met;
}

std::vector<Drive> way_of(const std::vector<char>& blades, std::span<const Drive> way) {
    std::vector<Drive> own(way.begin(), way.end());
    for (Drive& drive : own) {
        for (std::size_t b = 0; b < blades.size(); ++b) {
            if (!blades[b]) drive.world_from_blade[b] = own.front().world_from_blade[b];
        }
    }
    return own;
}

Vec3 way_between(const Blade& blade, const Pose& from, const Pose& to) {
    const Vec3 middle = middle_of_edge(blade);
    return to * middle - from * middle;
}

bool is_gripped(const Apparatus& apparatus, std::size_t body) {
    return std::ranges::any_of(apparatus.grip, [&](const Grip& grip) {
        return static_cast<std::size_t>(grip.body) == body && !grip.point.empty();
    });
}

std::size_t count_passed(const Aggregate& matter, const Vec3Array& before,
                         const Apparatus& apparatus, const Drive& from, const Drive& to,
                         const std::vector<char>& blades) {
    std::vector<Box> near;  // what each blade sweeps
    for (std::size_t b = 0; b < apparatus.blade.size(); ++b) {
        near.emplace_back();
        if (!blades.empty() && !blades[b]) continue;
        for (const auto& triangle : swept_triangles(apparatus.blade[b], from.world_from_blade[b],
                                                    to.world_from_blade[b])) {
            for (const Vec3& corner : triangle) near.back().grow(corner);
        }
        // A blade is looked at a little beside its place (sim/sever.cpp).
        near.back() = near.back().widened(1e-3 * matter.lattice.spacing);
    }
    // Seen from its middle a connection stands, and the blade comes by what that has moved less.
    const auto is_passed = [&](std::size_t b, std::size_t lower, std::size_t upper) {
        const std::array<Vec3, 2> was = {before.at(lower), before.at(upper)};
        const std::array<Vec3, 2> is = {matter.particle_position.at(lower),
                                        matter.particle_position.at(upper)};
        Box own;
        for (const auto& ends : {was, is}) {
            for (const Vec3& end : ends) own.grow(end);
        }
        if (!own.overlaps(near[b])) return false;
        Pose met = to.world_from_blade[b];
        met.translation -= 0.5 * (is[0] + is[1] - was[0] - was[1]);
        return crosses(swept_triangles(apparatus.blade[b], from.world_from_blade[b], met), was[0],
                       was[1], matter.lattice.spacing);
    };
    std::size_t count = 0;
    for (const Span& span : matter.lattice.span) {
        const SparseArray<float>& weight = matter.connection[span.direction].weight;
        for (int n = 0; n < span.count; ++n) {
            if (weight[span.lower + n] <= 0) continue;
            for (std::size_t b = 0; b < near.size(); ++b) {
                if (!is_passed(b, std::size_t(span.lower + n), std::size_t(span.upper + n))) {
                    continue;
                }
                ++count;
                break;
            }
        }
    }
    return count;
}

}  // namespace swage
