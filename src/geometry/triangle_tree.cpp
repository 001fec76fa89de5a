// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest point of a triangle by the regions of its plane (Ericson, Real-Time Collision Detection,
// 5.1.5). What a line crosses by Moeller and Trumbore 1997, boxes by their slabs. Solid angle of a
// triangle by van Oosterom and Strackee 1983; clusters far away are taken as one dipole, as in
// Barill et al., Fast Winding Numbers for Soups and Clouds, 2018.
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "base/portable_math.h"

namespace swage {

namespace {

constexpr int kLeafSize = 4;
constexpr double kDipoleReach = 2.5;  // radii from a cluster to where its dipole stands for it

// Of the corners: their mean is the place of the triangle that is nearest to p.
Vec3 nearest_weights(const Vec3& p, const std::array<Vec3, 3>& t) {
    const auto& [a, b, c] = t;
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    const Vec3 bp = p - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 != d3) {
        const double s = d1 / (d1 - d3);
        return {1 - s, s, 0};
    }
    const Vec3 cp = p - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 != d6) {
        const double s = d2 / (d2 - d6);
        return {1 - s, 0, s};
    }
    const double va = d3 * d6 - d5 * d4;
    const double e4 = d4 - d3, e5 = d5 - d6;
    if (va <= 0 && e4 >= 0 && e5 >= 0 && e4 + e5 > 0) {
        const double s = e4 / (e4 + e5);
        return {0, 1 - s, s};
    }
    const double sum = va + vb + vc;
    if (sum > 0) return {1 - vb / sum - vc / sum, vb / sum, vc / sum};
    // No area: the nearest of its edges, all of which were on one line.
    Vec3 best(1, 0, 0);
    double least = std::numeric_limits<double>::infinity();
    for (int e = 0; e < 3; ++e) {
        const Vec3 along = t[(e + 1) % 3] - t[e];
        const double length = along.squaredNorm();
        const double s = length > 0 ? std::clamp(along.dot(p - t[e]) / length, 0.0, 1.0) : 0.0;
        const double far = (p - t[e] - s * along).squaredNorm();
        if (!(far < least)) continue;
        least = far;
        best.setZero();
        best[e] = 1 - s, best[(e + 1) % 3] = s;
    }
    return best;
}

double squared_distance(const Vec3& p, const std::array<Vec3, 3>& t) {
    const Vec3 weight = nearest_weights(p, t);
    return (p - weight[0] * t[0] - weight[1] * t[1] - weight[2] * t[2]).squaredNorm();
}

double solid_angle(const Vec3& p, const std::array<Vec3, 3>& t) {
    const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    const double volume = a.dot(b.cross(c));
    const double side = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    return 2 * portable::atan2(volume, side);
}

double squared_distance(const Vec3& p, const Box& box) {
    const Vec3 nearest = p.cwiseMax(box.low).cwiseMin(box.high);
    return (p - nearest).squaredNorm();
}

// Whether from + s * way, 0 <= s <= 1, meets the triangle.
bool crosses(const Vec3& from, const Vec3& way, const std::array<Vec3, 3>& t) {
    const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], p = way.cross(ac);
    const double det = ab.dot(p);
    if (det == 0) return false;
    const Vec3 start = from - t[0], q = start.cross(ab);
    const double u = start.dot(p) / det, v = way.dot(q) / det, s = ac.dot(q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && s >= 0 && s <= 1;
}

bool crosses(const Vec3& from, const Vec3& way, const Box& box) {
    double enters = 0, leaves = 1;
    for (int d = 0; d < 3; ++d) {
        if (way[d] == 0) {
            if (from[d] < box.low[d] || from[d] > box.high[d]) return false;
            continue;
        }
        const double one = (box.low[d] - from[d]) / way[d];
        const double other = (box.high[d] - from[d]) / way[d];
        enters = std::max(enters, std::min(one, other));
        leaves = std::min(leaves, std::max(one, other));
    }
    // Boxes of flat faces have no thickness: rounding may not lose them.
    return enters <= leaves + 1e-12;
}

}  // namespace

TriangleTree::TriangleTree(const TriMesh& mesh) {
    if (mesh.triangle.empty()) fail(ExitCode::mesh, "a surface without triangles has no distance");
    const int count = static_cast<int>(mesh.triangle.size());
    std::vector<std::array<Vec3, 3>> corners(count);
    std::vector<Vec3> centroid(count);
    for (int t = 0; t < count; ++t) {
        for (int c = 0; c < 3; ++c) corners[t][c] = mesh.position[mesh.triangle[t][c]];
        centroid[t] = (corners[t][0] + corners[t][1] + corners[t][2]) / 3;
    }
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    triangle_ = corners;  // for build(); put in the order of the leaves below
    node_.reserve(2 * static_cast<std::size_t>(count) / kLeafSize + 1);
    build(order, centroid, 0, count);
    for (int t = 0; t < count; ++t) triangle_[t] = corners[order[t]];
    number_ = std::move(order);
}

int TriangleTree::build(std::vector<int>& order, const std::vector<Vec3>& centroid, int first,
                        int count) {
    Node node;
    node.first = first;
    node.count = count;
    Box spread;
    double total = 0;
    for (int n = first; n < first + count; ++n) {
        const auto& [a, b, c] = triangle_[order[n]];
        for (const Vec3& corner : triangle_[order[n]]) node.box.grow(corner);
        spread.grow(centroid[order[n]]);
        const Vec3 area = 0.5 * (b - a).cross(c - a);
        node.area += area;
        node.centre += area.norm() * centroid[order[n]];
        total += area.norm();
    }
    node.centre = total > 0 ? Vec3(node.centre / total) : spread.center();
    const Vec3 reach = (node.centre - node.box.low).cwiseMax(node.box.high - node.centre);
    node.radius = reach.norm();

    const int self = static_cast<int>(node_.size());
    node_.push_back(node);
    if (count <= kLeafSize) return self;
    int axis = 0;
    spread.size().maxCoeff(&axis);
    const int half = count / 2;
    std::nth_element(order.begin() + first, order.begin() + first + half,
                     order.begin() + first + count, [&](int s, int t) {
                         return centroid[s][axis] != centroid[t][axis]
                                    ? centroid[s][axis] < centroid[t][axis]
                                    : s < t;
                     });
    const int left = build(order, centroid, first, half);
    const int right = build(order, centroid, first + half, count - half);
    node_[self].left = left;
    node_[self].right = right;
    return self;
}

TriangleTree::Found TriangleTree::find(const Vec3& point) const {
    Found best{0, std::numeric_limits<double>::infinity()};
    std::array<std::pair<int, double>, 96> stack;  // deeper than any tree of 2^31 triangles
    int depth = 0;
    stack[depth++] = {0, 0.0};
    while (depth > 0) {
        const auto [at, near] = stack[--depth];
        if (near >= best.squared_distance) continue;
        const Node& node = node_[at];
        if (node.left < 0) {
            for (int n = node.first; n < node.first + node.count; ++n) {
                const double d = squared_distance(point, triangle_[n]);
                if (d < best.squared_distance) best = {n, d};
            }
            continue;
        }
        const double left = squared_distance(point, node_[node.left].box);
        const double right = squared_distance(point, node_[node.right].box);
        const bool left_first = left <= right;
        stack[depth++] = left_first ? std::pair(node.right, right) : std::pair(node.left, left);
        stack[depth++] = left_first ? std::pair(node.left, left) : std::pair(node.right, right);
    }
    return best;
}

double TriangleTree::distance(const Vec3& point) const {
    return std::sqrt(find(point).squared_distance);
}

TriangleTree::Nearest TriangleTree::nearest(const Vec3& point) const {
    const int at = find(point).at;
    return {number_[at], nearest_weights(point, triangle_[at])};
}

bool TriangleTree::lies_between(const Vec3& from, const Vec3& to) const {
    const Vec3 way = to - from;
    std::array<int, 96> stack;
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = node_[stack[--depth]];
        if (!crosses(from, way, node.box)) continue;
        if (node.left < 0) {
            for (int n = node.first; n < node.first + node.count; ++n) {
                if (crosses(from, way, triangle_[n])) return true;
            }
            continue;
        }
        stack[depth++] = node.right;
        stack[depth++] = node.left;
    }
    return false;
}

double TriangleTree::winding_number(const Vec3& point) const {
    double sum = 0;  // of solid angles
    std::array<int, 96> stack;
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = node_[stack[--depth]];
        const Vec3 to = node.centre - point;
        const double away = to.squaredNorm();
        const double reach = kDipoleReach * node.radius;
        if (away > reach * reach) {
            sum += node.area.dot(to) / (away * std::sqrt(away));
        } else if (node.left < 0) {
            for (int n = node.first; n < node.first + node.count; ++n) {
                sum += solid_angle(point, triangle_[n]);
            }
        } else {
            stack[depth++] = node.left;
            stack[depth++] = node.right;
        }
    }
    return sum / (4 * kPi);
}

}  // namespace swage
