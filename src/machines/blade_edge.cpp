// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/blade_edge.h"

#include <algorithm>

#include "geometry/box.h"
#include "machines/told_at.h"

namespace swage {

namespace {

constexpr double kSame = 1e-9;  // of the edge's size: two ends are one point

std::vector<Vec3> points_of(const BladeSpec& spec, Variables known) {
    std::vector<Vec3> edge;
    if (spec.edge.size() > 1) {
        for (const Expression3& point : spec.edge) {
            edge.push_back(evaluate(point, known, Quantity::length));
        }
    } else if (!spec.edge.empty()) {
        for (int n = 0; n < spec.points; ++n) {
            known["along"] = static_cast<double>(n) / (spec.points - 1);
            edge.push_back(evaluate(spec.edge[0], known, Quantity::length));
        }
    }
    return edge;
}

}  // namespace

std::vector<Vec3> edge_of(const BladeSpec& spec, const Variables& known) {
    std::vector<Vec3> edge = points_of(spec, known);
    const double size = edge.empty() ? 0.0 : box_of(edge).size().norm();
    const bool is_closed = size > 0 && (edge.back() - edge.front()).norm() <= kSame * size;
    if (!(size > 0) || (is_closed && edge.size() < 4)) {
        throw PlacedError(spec.edge.empty() ? TextPlace() : spec.edge[0][0].place,
                          fmt::format("the edge of blade {} {}", spec.name,
                                      edge.size() < 3 ? "needs at least two different points"
                                                      : "begins and ends at one point"));
    }
    if (is_closed) edge.back() = edge.front();
    return edge;
}

Vec3 farthest_forth(const std::vector<Vec3>& way) {
    double most = 0;
    for (const Vec3& one : way) most = std::max(most, one.norm());
    const auto first =
        std::ranges::find_if(way, [&](const Vec3& one) { return one.norm() >= 0.25 * most; });
    return *std::ranges::max_element(way, {}, [&](const Vec3& one) { return one.dot(*first); });
}

}  // namespace swage
