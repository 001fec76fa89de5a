// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/blade_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/principal_axes.h"
#include "geometry/disjoint_sets.h"
#include "skin/flat_segment.h"
#include "skin/sheet_normals.h"

namespace swage {

namespace {

using Sweep = std::vector<std::array<Vec3, 3>>;

constexpr double kLeast = 0.1736;  // the cosine of 80 degrees
// Of the angle between two that lean by as much to opposite sides.
constexpr double kMostTurned = 2 * kLeast * kLeast - 1;
constexpr int kRounds = 200;
constexpr double kRounding = 1e-12;  // of a place in its triangle, as a share of their size
// Of plane and relief, how far off their triangles may be.
constexpr double kLooser = 50;

Vec3 area_of(const std::array<Vec3, 3>& t) { return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]); }

bool holds(const std::array<Vec2, 3>& t, const Vec2& p) {
    const double a = cross(t[1] - t[0], p - t[0]);
    const double b = cross(t[2] - t[1], p - t[1]);
    const double c = cross(t[0] - t[2], p - t[2]);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

struct Areas {
    Vec3 sum = Vec3::Zero();
    Vec3 middle = Vec3::Zero();
};

// A blade that goes forth and back sweeps areas of both signs. Nothing when there is none.
std::optional<Areas> areas_of(const Sweep& sweep) {
    Areas areas;
    double total = 0;
    for (const auto& t : sweep) {
        Vec3 own = area_of(t);
        if (own.dot(areas.sum) < 0) own = -own;
        areas.sum += own;
        areas.middle += own.norm() * (t[0] + t[1] + t[2]) / 3;
        total += own.norm();
    }
    if (!(total > 0)) return std::nullopt;
    areas.middle /= total;
    return areas;
}

// Of the smallest cap that holds all directions (Badoiu and Clarkson 2003: towards the farthest by
// ever less).
Vec3 middle_of(const std::vector<Vec3>& directions) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& one : directions) middle += one;
    middle.normalize();
    for (int round = 1; round <= kRounds; ++round) {
        const auto nearness = [&](const Vec3& one) { return middle.dot(one); };
        const Vec3& farthest = *std::ranges::min_element(directions, {}, nearness);
        middle = (middle + (farthest - middle) / (round + 1)).normalized();
    }
    return middle;
}

// The direction from which they lean away least. A sheet may look along it or against it.
struct Lean {
    Vec3 from;
    double least = -1;  // the cosine of the most
};

// Of two or more sheets those are tried that lie about as most of their normals or across these.
Lean least_lean(const std::vector<std::vector<Vec3>>& sheets, const Mat3& axes) {
    Lean best;
    for (int axis = 2; axis >= (sheets.size() > 1 ? 0 : 2); --axis) {
        std::vector<Vec3> all;
        for (const std::vector<Vec3>& sheet : sheets) {
            Vec3 sum = Vec3::Zero();
            for (const Vec3& one : sheet) sum += one;
            const double side = sum.dot(axes.col(axis)) < 0 ? -1 : 1;
            for (const Vec3& one : sheet) all.push_back(side * one);
        }
        Lean lean{middle_of(all), 1};
        for (const Vec3& one : all) lean.least = std::min(lean.least, lean.from.dot(one));
        if (lean.least > best.least) best = lean;
    }
    return best;
}

void lay_flat(const Sweep& sweep, BladePath& path) {
    struct Use {
        std::array<Vec2, 2> edge;
        int count = 0;
    };
    std::map<std::array<double, 6>, Use> uses;  // by the ends in the world, which agree to the bit
    for (const auto& t : sweep) {
        if ((t[1] - t[0]).cross(t[2] - t[0]).norm() == 0) continue;
        path.triangle.push_back({path.flat(t[0]), path.flat(t[1]), path.flat(t[2])});
        for (int k = 0; k < 3; ++k) {
            const Vec3 &a = t[k], &b = t[(k + 1) % 3];
            std::array<double, 6> key = {a[0], a[1], a[2], b[0], b[1], b[2]};
            const std::array<double, 6> back = {b[0], b[1], b[2], a[0], a[1], a[2]};
            Use& use = uses[std::min(key, back)];
            use.edge = {path.flat(a), path.flat(b)};
            ++use.count;
        }
    }
    for (const auto& [key, use] : uses) {
        if (use.count == 1) path.outline.push_back(use.edge);
    }
}

// With what of the plane lies under the triangles.
BladePath over_plane(const Sweep& sweep, const Vec3& point, const Vec3& normal) {
    BladePath path;
    path.point = point;
    path.normal = normal;
    int least = 0;
    path.normal.cwiseAbs().minCoeff(&least);
    path.across = path.normal.cross(Vec3::Unit(least)).normalized();
    path.up = path.normal.cross(path.across);
    lay_flat(sweep, path);
    return path;
}

// Whether any two of them, where both lie over a place, have heights that differ by more than this.
bool lie_over_each_other(const std::vector<std::array<Vec2, 3>>& triangle,
                         const std::vector<std::array<double, 3>>& height, double tolerance) {
    const auto low = [&](std::size_t t, int axis) {
        return std::min({triangle[t][0][axis], triangle[t][1][axis], triangle[t][2][axis]});
    };
    const auto high = [&](std::size_t t, int axis) {
        return std::max({triangle[t][0][axis], triangle[t][1][axis], triangle[t][2][axis]});
    };
    const auto height_at = [&](std::size_t t, const Vec2& p) {
        const auto& [a, b, c] = triangle[t];
        const double v = cross(p - a, c - a) / cross(b - a, c - a);
        const double w = cross(b - a, p - a) / cross(b - a, c - a);
        return height[t][0] + v * (height[t][1] - height[t][0]) + w * (height[t][2] - height[t][0]);
    };
    std::vector<std::size_t> order(triangle.size());
    for (std::size_t t = 0; t < order.size(); ++t) order[t] = t;
    std::ranges::stable_sort(order, {}, [&](std::size_t t) { return low(t, 0); });
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::size_t s = order[i];
        for (std::size_t j = i + 1; j < order.size() && low(order[j], 0) <= high(s, 0); ++j) {
            const std::size_t t = order[j];
            if (low(t, 1) > high(s, 1) || low(s, 1) > high(t, 1)) continue;
            for (const auto& [own, other] : {std::pair(s, t), std::pair(t, s)}) {
                const auto& [a, b, c] = triangle[own];
                for (const Vec2& p : {a, b, c, Vec2((a + b + c) / 3)}) {
                    if (!holds(triangle[other], p)) continue;
                    const double off = height_at(own, p) - height_at(other, p);
                    if (std::abs(off) > tolerance) return true;
                }
            }
        }
    }
    return false;
}

// Nothing where one leans too much.
std::optional<BladePath> round_axis(const Sweep& sweep, const Vec3& point, const Vec3& axis,
                                    const Box& box) {
    BladePath path;
    path.point = point;
    path.up = axis;
    int least = 0;
    path.up.cwiseAbs().minCoeff(&least);
    path.normal = Vec3::Unit(least).cross(path.up).normalized();
    path.across = path.up.cross(path.normal);
    path.first = 1;  // round, before it is known how much
    double steep = 1, radius = 0;
    int count = 0;
    for (const auto& t : sweep) {
        const Vec3 area = area_of(t), middle = (t[0] + t[1] + t[2]) / 3;
        if (area.norm() == 0) continue;
        steep = std::min(steep, std::abs(area.normalized().dot(path.rise(middle))));
        radius += path.height(middle);
        ++count;
    }
    if (steep < kLeast) return std::nullopt;
    path.steepest = 1 / steep;
    double low = 0;
    for (int corner = 0; corner < 8; ++corner) {
        low = std::min(low, axis.dot(box.corner(corner) - point));
    }
    path.radius = radius / count;
    path.first = path.radius - low;
    lay_flat(sweep, path);
    return path;
}

// Whether the triangles do not lie over each other.
bool lay_relief(const Sweep& sweep, double tolerance, BladePath& path) {
    TriMesh flat;
    std::vector<std::array<double, 3>> height;
    Sweep swept;
    for (const auto& t : sweep) {
        if (area_of(t).norm() == 0) continue;
        swept.push_back(t);
        std::array<double, 3>& own = height.emplace_back();
        for (int k = 0; k < 3; ++k) {
            own[k] = path.height(t[k]);
            const Vec2 at = path.flat(t[k]);
            flat.position.emplace_back(at.x(), at.y(), 0);
        }
        const int first = static_cast<int>(flat.position.size()) - 3;
        flat.triangle.push_back({first, first + 1, first + 2});
    }
    if (lie_over_each_other(path.triangle, height, tolerance)) return false;
    path.relief = std::make_shared<const Relief>(
        Relief{TriangleTree(flat), std::move(height), std::move(swept), path.point});
    return true;
}

// One sweep for each blade: triangles that hang together by corners.
std::vector<Sweep> separate_sweeps(const Sweep& sweep) {
    std::map<std::array<double, 3>, int> first;
    DisjointSets sets(sweep.size());
    for (std::size_t t = 0; t < sweep.size(); ++t) {
        for (const Vec3& p : sweep[t]) {
            const auto [at, fresh] =
                first.emplace(std::array<double, 3>{p[0], p[1], p[2]}, static_cast<int>(t));
            if (!fresh) sets.unite(at->second, static_cast<int>(t));
        }
    }
    std::vector<int> number;
    std::vector<Sweep> separate(sets.number_sets(number));
    for (std::size_t t = 0; t < sweep.size(); ++t) separate[number[t]].push_back(sweep[t]);
    return separate;
}

// As that of a blade at rest.
bool has_no_area(const Sweep& sweep) {
    return std::ranges::all_of(sweep, [](const auto& t) { return area_of(t).norm() == 0; });
}

// What of a sweep comes near the box.
Sweep near_box(const Sweep& sweep, const Box& box) {
    Sweep near;
    for (const std::array<Vec3, 3>& t : sweep) {
        if (box_of({t.begin(), t.end()}).overlaps(box)) near.push_back(t);
    }
    return near;
}

Sweep joined(const std::vector<Sweep>& parts) {
    Sweep all;
    for (const Sweep& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace

double Relief::at(const Vec2& p) const {
    const auto [triangle, weight] = flat.nearest({p[0], p[1], 0});
    const std::array<double, 3>& own = height[static_cast<std::size_t>(triangle)];
    return weight[0] * own[0] + weight[1] * own[1] + weight[2] * own[2];
}

double BladePath::height(const Vec3& p) const {
    const Vec3 way = p - point;
    const double over = first > 0 ? Vec2(across.dot(way), normal.dot(way)).norm() : normal.dot(way);
    return relief ? over - relief->at(flat(p)) : over;
}

Vec2 BladePath::flat(const Vec3& p) const {
    const Vec3 way = p - point;
    if (first == 0) return {across.dot(way), up.dot(way)};
    const Vec2 out(across.dot(way), normal.dot(way));
    const double radius = out.norm();
    return (first + up.dot(way)) * (radius > 0 ? Vec2(out / radius) : Vec2(1, 0));
}

Vec3 BladePath::world(const Vec2& p) const {
    const double over = relief ? relief->at(p) : 0.0;
    if (first == 0) {
        const Vec3 below = point + p[0] * across + p[1] * up;
        return relief ? Vec3(below + over * normal) : below;
    }
    const double far = p.norm();
    const Vec2 out = far > 0 ? Vec2(p / far) : Vec2(1, 0);
    return point + over * (out[0] * across + out[1] * normal) + (far - first) * up;
}

// Far out on a band what lies between is not what lies between on the path.
Vec2 BladePath::middle(const Vec2& a, const Vec2& b) const {
    if (first == 0) return 0.5 * (a + b);
    return 0.5 * (a.norm() + b.norm()) * (a.normalized() + b.normalized()).normalized();
}

Vec2 BladePath::middle(const Vec2& a, const Vec2& b, const Vec2& c) const {
    if (first == 0) return a / 3 + b / 3 + c / 3;
    return (a.norm() + b.norm() + c.norm()) / 3 *
           (a.normalized() + b.normalized() + c.normalized()).normalized();
}

int BladePath::side(const Vec3& p) const {
    if (first == 0) return height(p) >= 0 ? 1 : -1;
    const Vec2 at = flat(p);
    const auto& t = relief->swept[relief->flat.nearest({at[0], at[1], 0}).triangle];
    const Vec3 area = area_of(t);
    const double out = area.dot(p - (point - relief->point) - t[0]);
    return (area.dot(rise(p)) < 0 ? -out : out) >= 0 ? 1 : -1;
}

Vec3 BladePath::rise(const Vec3& p) const {
    if (first == 0) return normal;
    const Vec3 way = p - point;
    const Vec3 out = across.dot(way) * across + normal.dot(way) * normal;
    return out.norm() > 0 ? Vec3(out.normalized()) : normal;
}

bool BladePath::near(const Vec2& p, double reach) const {
    if (relief) {
        const auto& [a, b, c] = triangle[relief->flat.nearest({p[0], p[1], 0}).triangle];
        const double size = p.cwiseAbs().maxCoeff() + (b - a).norm() + (c - a).norm();
        return relief->flat.distance({p[0], p[1], 0}) <= std::max(reach, kRounding * size);
    }
    for (const auto& t : triangle) {
        const Vec2 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]);
        const Vec2 high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
        if ((p.array() < low.array() - reach).any() || (p.array() > high.array() + reach).any()) {
            continue;
        }
        if (holds(t, p)) return true;
        for (int k = 0; k < 3 && reach > 0; ++k) {
            if (distance2_to_segment(p, t[k], t[(k + 1) % 3]) <= reach * reach) return true;
        }
    }
    return false;
}

std::optional<BladePath> flat_path(const Sweep& sweep, double tolerance) {
    const auto areas = areas_of(sweep);
    if (!areas) return std::nullopt;
    BladePath path = over_plane(sweep, areas->middle, areas->sum.normalized());
    for (const auto& t : sweep) {
        for (const Vec3& p : t) {
            if (std::abs(path.height(p)) > tolerance) return std::nullopt;
        }
    }
    return path;
}

std::optional<BladePath> bent_path(const Sweep& sweep, const Box& box, double tolerance) {
    const auto areas = areas_of(sweep);
    if (!areas) return std::nullopt;
    const std::vector<std::vector<Vec3>> sheets = sheet_normals(sweep, kMostTurned);
    Mat3 square = Mat3::Zero();
    for (const std::vector<Vec3>& sheet : sheets) {
        for (const Vec3& normal : sheet) square += normal * normal.transpose();
    }
    const Mat3 axes = principal_axes(square).axis;
    const Lean lean = least_lean(sheets, axes);
    if (lean.least >= kLeast) {
        BladePath path = over_plane(sweep, areas->middle, lean.from);
        path.steepest = 1 / lean.least;
        if (lay_relief(sweep, tolerance, path)) return path;
    }
    for (const int axis : {0, 1, 2}) {
        auto path = round_axis(sweep, areas->middle, axes.col(axis), box);
        if (path && lay_relief(sweep, tolerance, *path)) return path;
    }
    return std::nullopt;
}

BladePaths blade_paths(const Sweep& sweep, const Box& box, double tolerance) {
    BladePaths found;
    for (const Sweep& one : separate_sweeps(sweep)) {
        if (const auto plane = flat_path(one, tolerance)) {
            found.path.push_back(*plane);
            continue;
        }
        std::vector<Sweep> bent;
        for (const Sweep& part : separate_sweeps(near_box(one, box))) {
            if (has_no_area(part)) continue;
            if (auto plane = flat_path(part, tolerance)) {
                found.path.push_back(std::move(*plane));
            } else {
                bent.push_back(part);
            }
        }
        // The way back of a blade lies on its way there.
        if (auto all = bent_path(joined(bent), box, kLooser * tolerance)) {
            found.path.push_back(std::move(*all));
            continue;
        }
        for (const Sweep& part : bent) {
            auto path = bent_path(part, box, kLooser * tolerance);
            if (path) found.path.push_back(std::move(*path));
            found.has_folded = found.has_folded || !path;
        }
    }
    return found;
}

}  // namespace swage
