// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's own union is not used: it refuses a result that touches itself along an edge, and that of
// CGAL 5.5 never ends for some bodies whose faces lie on each other.
#include "geometry/mesh_unite.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/box.h"
#include "geometry/close_points.h"
#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"
#include "geometry/mesh_edit.h"
#include "geometry/mesh_repair_cgal.h"
#include "geometry/mesh_shells.h"
#include "geometry/triangle_tree.h"

namespace swage {

namespace {

constexpr double kOnSurface = 1e-9;  // of the size of both: no further from it

Vec3 middle_of(const TriMesh& mesh, std::size_t t) {
    const auto& [a, b, c] = mesh.triangle[t];
    return (mesh.position[a] + mesh.position[b] + mesh.position[c]) / 3;
}

enum class Common { no, yes };

// Which patches of one surface bound the union with another, or what both have in common. Where the
// two lie on each other and face the same way only `keep_common` ones do.
std::vector<char> bounding_patches(const CutPatches& cut, const TriMesh& other, double gap,
                                   Common part, bool keep_common) {
    const TriangleTree tree(other);
    std::vector<std::vector<int>> of_patch;
    std::vector<double> area;
    for (std::size_t t = 0; t < cut.patch.size(); ++t) {
        const auto p = static_cast<std::size_t>(cut.patch[t]);
        if (p >= of_patch.size()) of_patch.resize(p + 1);
        of_patch[p].push_back(static_cast<int>(t));
        area.push_back(area_vector(cut.mesh.position, cut.mesh.triangle[t]).norm());
    }
    const auto is_off = [&](int t) { return tree.distance(middle_of(cut.mesh, t)) > gap; };
    const auto is_smaller = [&](int s, int t) { return area[s] < area[t]; };
    std::vector<char> bounds;
    for (std::vector<int>& patch : of_patch) {
        int t = *std::ranges::max_element(patch, is_smaller);
        bool off = is_off(t);
        if (!off) {
            // A face that lies on the other but for rounding is not always parted from the body
            // that it bounds, most of which then lies elsewhere.
            const auto on = std::partition(patch.begin(), patch.end(), is_off);
            double beside = 0, all = 0;
            for (auto at = patch.begin(); at != patch.end(); ++at) {
                all += area[*at];
                beside += at < on ? area[*at] : 0;
            }
            off = beside > 0.5 * all;
            if (off) t = *std::max_element(patch.begin(), on, is_smaller);
        }
        if (off) {
            const bool outer = std::abs(tree.winding_number(middle_of(cut.mesh, t))) < 0.5;
            bounds.push_back(outer == (part == Common::no));
            continue;
        }
        const Corners& c = cut.mesh.triangle[t];
        const Corners& beneath = other.triangle[tree.nearest(middle_of(cut.mesh, t)).triangle];
        const bool agree =
            area_vector(cut.mesh.position, c).dot(area_vector(other.position, beneath)) > 0;
        bounds.push_back(agree && keep_common);
    }
    return bounds;
}

// Vertices within the gap become one: rounding alone tells them apart. That opens no surface. What
// then stands twice, back to back, goes.
void merge_close(TriMesh& mesh, std::vector<int>& origin, double gap) {
    DisjointSets same(mesh.position.size());
    for_each_close_pair(mesh.position, gap, [&](int i, int j) { same.unite(i, j); });
    std::map<Corners, std::vector<int>> standing;  // by sorted corners: one way or the other only
    std::vector<char> keep(mesh.triangle.size(), 0);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        Corners& c = mesh.triangle[t];
        for (int& i : c) i = same.root(i);
        if (has_repeated_corner(c)) continue;
        Corners sorted = c;
        std::sort(sorted.begin(), sorted.end());
        std::vector<int>& here = standing[sorted];
        keep[t] = here.empty() || corners_ascend(mesh.triangle[here.back()]) == corners_ascend(c);
        if (keep[t]) {
            here.push_back(static_cast<int>(t));
        } else {
            keep[here.back()] = 0;
            here.pop_back();
        }
    }
    std::size_t next = 0;
    for (std::size_t t = 0; t < keep.size(); ++t)
        if (keep[t]) origin[next++] = origin[t];
    origin.resize(next);
    keep_triangles(mesh, keep);
}

// Triangles whose three corners lie in a row but for `gap` go; the middle one becomes a corner of
// the neighbour across the longest side, which it lies on.
void drop_flat(TriMesh& mesh, std::vector<int>& origin, double gap) {
    std::map<std::pair<int, int>, std::vector<int>> at_side;  // from, to: triangles
    const auto side = [&](int t, int k) {
        return std::pair{mesh.triangle[t][k], mesh.triangle[t][(k + 1) % 3]};
    };
    const auto put = [&](int t) {
        for (int k = 0; k < 3; ++k) at_side[side(t, k)].push_back(t);
    };
    const auto take = [&](int t) {
        for (int k = 0; k < 3; ++k) std::erase(at_side[side(t, k)], t);
    };
    const auto longest_of = [&](int t) {
        int longest = 0;
        double most = -1;
        for (int k = 0; k < 3; ++k) {
            const auto [from, to] = side(t, k);
            const double length = (mesh.position[to] - mesh.position[from]).squaredNorm();
            if (length > most) {
                most = length;
                longest = k;
            }
        }
        const bool flat =
            area_vector(mesh.position, mesh.triangle[t]).norm() <= 0.5 * gap * std::sqrt(most);
        return flat ? longest : -1;
    };
    std::vector<int> flat;
    for (int t = 0; t < static_cast<int>(mesh.triangle.size()); ++t)
        if (longest_of(t) >= 0) flat.push_back(t);
    if (flat.empty()) return;
    for (int t = 0; t < static_cast<int>(mesh.triangle.size()); ++t) put(t);
    // A turn may leave a neighbour flat in its place.
    for (std::size_t tries = 4 * flat.size(); !flat.empty() && tries > 0; --tries) {
        const int t = flat.back();
        flat.pop_back();
        const int k = longest_of(t);
        if (k < 0) continue;
        const auto [from, to] = side(t, k);
        const int middle = mesh.triangle[t][(k + 2) % 3];
        const auto& across = at_side[{to, from}];
        if (across.size() != 1 || at_side[{from, to}].size() != 1) continue;
        const int n = across[0];
        const Corners& c = mesh.triangle[n];
        const int apex = c[0] != from && c[0] != to   ? c[0]
                         : c[1] != from && c[1] != to ? c[1]
                                                      : c[2];
        if (apex == middle || !at_side[{apex, middle}].empty() || !at_side[{middle, apex}].empty())
            continue;
        take(t);
        take(n);
        mesh.triangle[t] = {middle, apex, to};
        mesh.triangle[n] = {middle, from, apex};
        origin[t] = origin[n];
        put(t);
        put(n);
        for (const int again : {t, n})
            if (longest_of(again) >= 0) flat.push_back(again);
    }
}

// Whether what does not bound the result lies on its other side, or on it. A patch that is not
// parted where it should be lies neither in nor out; one with all of its corners on the result may
// still be the wall between them.
bool parts_well(const TriangleTree& result, const CutPatches& cut, const std::vector<char>& bounds,
                double gap, Common part) {
    const auto is_amiss = [&](const Vec3& p) {
        return (result.winding_number(p) > 0.5) == (part == Common::yes);
    };
    enum Place : char { unknown, on, beside };
    std::vector<Place> place(cut.mesh.position.size(), unknown);
    for (std::size_t t = 0; t < cut.patch.size(); ++t) {
        if (bounds[cut.patch[t]]) continue;
        bool all_on = true;
        for (const int i : cut.mesh.triangle[t]) {
            const Vec3& p = cut.mesh.position[i];
            if (place[i] == unknown) {
                place[i] = result.distance(p) > gap ? beside : on;
                if (place[i] == beside && is_amiss(p)) return false;
            }
            all_on = all_on && place[i] == on;
        }
        if (!all_on) continue;
        const Vec3 middle = middle_of(cut.mesh, t);
        if (result.distance(middle) > gap && is_amiss(middle)) return false;
    }
    return true;
}

double size_of(const TriMesh& a, const TriMesh& b) {
    Box box = box_of(a.position);
    box.grow(box_of(b.position));
    return box.size().norm();
}

// What is no further apart than `close` [m] in the result is one vertex.
bool combine(const TriMesh& a, const TriMesh& b, Common part, double close, TriMesh& result,
             std::vector<int>& origin) {
    CutPatches cut_a, cut_b;
    if (!cut_along_each_other(split_fans(a), split_fans(b), cut_a, cut_b)) return false;
    const double gap = kOnSurface * size_of(a, b);
    result = TriMesh();
    origin.clear();
    std::map<std::array<double, 3>, int> place;
    const auto add = [&](const CutPatches& cut, const std::vector<char>& bounds, int base) {
        for (std::size_t t = 0; t < cut.patch.size(); ++t) {
            if (!bounds[cut.patch[t]]) continue;
            Corners corners = cut.mesh.triangle[t];
            for (int& i : corners) {
                const Vec3& p = cut.mesh.position[i];
                const auto [at, is_new] = place.emplace(std::array{p.x(), p.y(), p.z()},
                                                        static_cast<int>(result.position.size()));
                if (is_new) result.position.push_back(p);
                i = at->second;
            }
            result.triangle.push_back(corners);
            origin.push_back(base + cut.origin[t]);
        }
    };
    const std::vector<char> bounds_a = bounding_patches(cut_a, b, gap, part, true),
                            bounds_b = bounding_patches(cut_b, a, gap, part, false);
    add(cut_a, bounds_a, 0);
    add(cut_b, bounds_b, static_cast<int>(a.triangle.size()));
    merge_close(result, origin, close);
    if (!is_closed(result)) return false;
    if (result.triangle.empty()) return part == Common::yes;
    const TriangleTree tree(result);
    if (!parts_well(tree, cut_a, bounds_a, 2 * close, part) ||
        !parts_well(tree, cut_b, bounds_b, 2 * close, part)) {
        return false;
    }
    drop_flat(result, origin, 2 * close);
    drop_unused_positions(result);
    return true;
}

bool combine_grown(const TriMesh& a, const TriMesh& b, Common part, double grown_by,
                   TriMesh& result, std::vector<int>& origin) {
    const double by = grown_by * size_of(a, b);
    const Box box = box_of(b.position);
    const Eigen::Array3d half = (0.5 * box.size()).cwiseMax(by);
    const Vec3 larger = (half + by) / half;
    TriMesh grown = b;
    for (Vec3& p : grown.position) {
        p = box.center() + larger.cwiseProduct(p - box.center());
    }
    return combine(a, grown, part, 4 * by, result, origin);
}

}  // namespace

bool unite(const TriMesh& a, const TriMesh& b, TriMesh& result, std::vector<int>& origin) {
    return combine(a, b, Common::no, kOnSurface * size_of(a, b), result, origin);
}

bool unite_grown(const TriMesh& a, const TriMesh& b, double grown, TriMesh& result,
                 std::vector<int>& origin) {
    return combine_grown(a, b, Common::no, grown, result, origin);
}

bool intersect(const TriMesh& a, const TriMesh& b, TriMesh& result) {
    std::vector<int> origin;
    const double most = std::min(signed_volume(a), signed_volume(b));
    const auto is_in_both = [&](double within) {
        const double volume = signed_volume(result);
        return volume > -kOnSurface * most && volume < (1 + within) * most;
    };
    if (combine(a, b, Common::yes, kOnSurface * size_of(a, b), result, origin) &&
        is_in_both(10 * kGrown[0])) {
        return true;
    }
    return std::any_of(std::begin(kGrown), std::end(kGrown), [&](double grown) {
        return combine_grown(a, b, Common::yes, grown, result, origin) && is_in_both(10 * grown);
    });
}

}  // namespace swage
