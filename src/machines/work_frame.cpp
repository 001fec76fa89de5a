// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.h"
#include "machines/machine.h"
#include "matter/point_side.h"

namespace swage {

namespace {

constexpr double kAsLong = 0.99;

}  // namespace

std::vector<Vec3> surface_positions(const Aggregate& matter) {
    std::vector<Vec3> points(matter.surface.size());
    for (std::size_t p = 0; p < points.size(); ++p) points[p] = position_on_side(matter, p);
    return points;
}

WorkFrame place_work_frame(const Aggregate& matter, WorldAxis axis, WorldAxis up, bool upright,
                           const Box& shown) {
    const Box box = box_of(surface_positions(matter));
    if (box.empty()) fail(ExitCode::mesh, "the work-piece has no surface to place a machine at");

    Vec3 y = up == WorldAxis::automatic ? Vec3::UnitY() : direction_of(up);
    Vec3 x;
    if (axis == WorldAxis::automatic) {
        Vec3 side = shown.empty() ? box.size() : shown.size();
        if (upright) side -= side.cwiseProduct(y.cwiseAbs());  // what stands on it may be tall
        // Of sides that are as long the first: what rounding makes of them, and where surface is
        // sampled, does not turn a machine.
        int longest = 0;
        while (side[longest] < kAsLong * side.maxCoeff()) ++longest;
        x = Vec3::Unit(longest);
    } else {
        x = direction_of(axis);
    }
    if (up == WorldAxis::automatic && !upright && x.y() != 0) y = Vec3::UnitZ();
    if (x.cross(y).norm() == 0) {
        if (axis != WorldAxis::automatic) {
            fail(ExitCode::scene,
                 "up = \"{}\" lies along the work-piece's axis ({}); choose another up, or an axis "
                 "across it",
                 name_of(up), name_of(axis));
        }
        std::string across;
        for (const WorldAxis other : {WorldAxis::x, WorldAxis::y, WorldAxis::z}) {
            if (direction_of(other).cross(y).norm() == 0) continue;
            across += fmt::format("{}\"{}\"", across.empty() ? "" : " or ", name_of(other));
        }
        fail(ExitCode::scene,
             "up = \"{}\" lies along the longest side of the work-piece as it is now, which is its "
             "axis where none is given; set axis = {}, or another up",
             name_of(up), across);
    }
    Mat3 axes;
    axes << x, y, x.cross(y);
    return {{Quat(axes).normalized(), box.center()}, (axes.transpose() * box.size()).cwiseAbs()};
}

std::array<WorldAxis, 3> world_axes(const WorkFrame& frame) {
    std::array<WorldAxis, 3> axes;
    for (int n = 0; n < 3; ++n) {
        const Vec3 way = frame.world_from_work.turn(Vec3::Unit(n));
        int along;
        way.cwiseAbs().maxCoeff(&along);
        axes[n] = static_cast<WorldAxis>(1 + 2 * along + (way[along] < 0));
    }
    return axes;
}

}  // namespace swage
