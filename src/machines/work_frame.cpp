// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "base/error.h"
#include "machines/machine.h"

namespace swage {

namespace {

constexpr double kAsLong = 0.99;

std::optional<Vec3> direction_named(const std::string& name) {
    const std::size_t at = name.size() == 2 && (name[0] == '-' || name[0] == '+') ? 1 : 0;
    if (name.size() != at + 1) return std::nullopt;
    const std::size_t axis = std::string("xyz").find(name[at]);
    if (axis == std::string::npos) return std::nullopt;
    return (name[0] == '-' ? -1.0 : 1.0) * Vec3::Unit(static_cast<int>(axis));
}

Vec3 direction_or_fail(const std::string& key, const std::string& name) {
    const std::optional<Vec3> direction = direction_named(name);
    if (!direction) {
        fail(ExitCode::scene,
             "{} = \"{}\" is no direction; say \"auto\", or x, y, z with or "
             "without a minus sign",
             key, name);
    }
    return *direction;
}

}  // namespace

std::vector<Vec3> surface_positions(const Aggregate& matter) {
    std::vector<Vec3> points(matter.surface.size());
    for (std::size_t p = 0; p < points.size(); ++p) points[p] = matter.surface_position(p);
    return points;
}

WorkFrame place_work_frame(const Aggregate& matter, const std::string& axis, const std::string& up,
                           bool upright) {
    const Box box = box_of(surface_positions(matter));
    if (box.empty()) fail(ExitCode::mesh, "the work-piece has no surface to place a machine at");

    Vec3 y = up == "auto" ? Vec3::UnitY() : direction_or_fail("up", up);
    Vec3 x;
    if (axis == "auto") {
        Vec3 side = box.size();
        if (upright) side -= side.cwiseProduct(y.cwiseAbs());  // what stands on it may be tall
        // Of sides that are as long the first: what rounding makes of them, and where surface is
        // sampled, does not turn a machine.
        int longest = 0;
        while (side[longest] < kAsLong * side.maxCoeff()) ++longest;
        x = Vec3::Unit(longest);
    } else {
        x = direction_or_fail("axis", axis);
    }
    if (up == "auto" && !upright && x.y() != 0) y = Vec3::UnitZ();
    if (x.cross(y).norm() == 0) {
        fail(ExitCode::scene, "up = \"{}\" lies along the work-piece's axis ({}); choose another",
             up, axis == "auto" ? "its longest side" : axis);
    }
    Mat3 axes;
    axes << x, y, x.cross(y);
    return {{Quat(axes).normalized(), box.center()}, (axes.transpose() * box.size()).cwiseAbs()};
}

}  // namespace swage
