// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_shells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_edit.h"

namespace swage {

namespace {

constexpr double kSameTurn = 1e-9;  // of a quarter turn: triangles that lie on each other

// A triangle at an edge, seen along it.
struct Wing {
    double turn;  // 0 to 4: quarters of the way around, counter-clockwise, from the first
    EdgeUse use;
    bool opens;  // going around, matter begins here; else it ends
};

// In the order around the edge. Of those that lie on each other, matter's ends come first: bodies
// that touch along a face stay two.
std::vector<Wing> wings_of(const TriMesh& mesh, std::span<const EdgeUse> uses, bool inside_out) {
    const Vec3& low = mesh.position[uses[0].low];
    const Vec3 along = (mesh.position[uses[0].high] - low).normalized();
    const auto across = [&](const EdgeUse& use) -> Vec3 {
        const Vec3 arm = mesh.position[mesh.triangle[use.triangle][(use.side + 2) % 3]] - low;
        return arm - along * along.dot(arm);
    };
    const Vec3 x = across(uses[0]).normalized(), y = along.cross(x);
    std::vector<Wing> wings;
    for (const EdgeUse& use : uses) {
        const Vec3 arm = across(use);
        const double right = arm.dot(x), up = arm.dot(y);
        const double sum = std::abs(right) + std::abs(up);  // no angle, but in its order
        double turn = sum > 0 ? up / sum : 0;
        if (right < 0)
            turn = 2 - turn;
        else if (up < 0)
            turn += 4;
        if (turn > 4 - kSameTurn) turn = 0;
        wings.push_back({turn, use, use.forward == inside_out});
    }
    std::sort(wings.begin(), wings.end(), [](const Wing& a, const Wing& b) {
        return a.turn != b.turn ? a.turn < b.turn : a.use.triangle < b.use.triangle;
    });
    for (std::size_t i = 1; i < wings.size(); ++i)
        if (wings[i].turn - wings[i - 1].turn < kSameTurn) wings[i].turn = wings[i - 1].turn;
    // The lower of several in one place is nearer to the matter it bounds, on either side: of
    // surfaces that lie on each other the first ones in the file go together.
    std::sort(wings.begin(), wings.end(), [](const Wing& a, const Wing& b) {
        if (a.turn != b.turn) return a.turn < b.turn;
        if (a.opens != b.opens) return b.opens;
        return (a.use.triangle < b.use.triangle) != a.opens;
    });
    return wings;
}

// Of the triangles at an edge, as many that run along it in one direction as in the other, calls
// join(use, use) for two and two: like brackets, each pair with whole pairs only between them.
template <typename F>
void join_wedges(const TriMesh& mesh, std::span<const EdgeUse> uses, bool inside_out,
                 const F& join) {
    const std::vector<Wing> wings = wings_of(mesh, uses, inside_out);
    std::vector<EdgeUse> open;
    std::vector<char> joined(wings.size(), 0);
    for (const bool first_lap : {true, false})
        for (std::size_t i = 0; i < wings.size(); ++i) {
            if (wings[i].opens) {
                if (first_lap) open.push_back(wings[i].use);
            } else if (!joined[i] && !open.empty()) {
                join(open.back(), wings[i].use);
                open.pop_back();
                joined[i] = 1;
            }
        }
}

auto joiner(DisjointSets& sets) {
    return [&](const EdgeUse& a, const EdgeUse& b) { sets.unite(a.triangle, b.triangle); };
}

// As brackets in the order of the file, where the triangles of one body mostly stand together.
void join_in_order(const std::vector<EdgeUse>& uses, DisjointSets& sets) {
    std::vector<EdgeUse> open;
    for (const EdgeUse& use : uses) {
        if (open.empty() || open.back().forward == use.forward) {
            open.push_back(use);
            continue;
        }
        sets.unite(open.back().triangle, use.triangle);
        open.pop_back();
    }
}

// Those at an edge that have no partner among the triangles they are joined to already.
std::vector<EdgeUse> without_partner(std::span<const EdgeUse> uses, DisjointSets& sets) {
    std::vector<EdgeUse> left;
    for (const EdgeUse& use : uses) {
        const auto partner = std::find_if(left.begin(), left.end(), [&](const EdgeUse& other) {
            return other.forward != use.forward &&
                   sets.root(other.triangle) == sets.root(use.triangle);
        });
        if (partner == left.end())
            left.push_back(use);
        else
            left.erase(partner);
    }
    return left;
}

// How many of the shells enclose something.
std::size_t solid_count(const TriMesh& mesh, const std::vector<int>& shell, int count) {
    const double size = box_of(mesh.position).size().norm(), least = 1e-12 * size * size * size;
    const std::vector<double> volume = component_volumes(mesh, {count, shell});
    return static_cast<std::size_t>(
        std::count_if(volume.begin(), volume.end(), [&](double v) { return std::abs(v) > least; }));
}

}  // namespace

std::vector<int> shells_of(const TriMesh& mesh) {
    DisjointSets sets(mesh.triangle.size());
    const std::vector<EdgeUse> all_uses = edge_uses(mesh.triangle, mesh.position.size());
    std::vector<std::span<const EdgeUse>> crowded;
    for_each_edge(all_uses, [&](std::span<const EdgeUse> uses) {
        if (uses.size() > 2 && excess(uses) == 0) {
            crowded.push_back(uses);
            return;
        }
        for (std::size_t i = 1; i < uses.size(); ++i)
            sets.unite(uses[0].triangle, uses[i].triangle);
    });
    const bool inside_out = !crowded.empty() && signed_volume(mesh) < 0;
    if (!mesh.triangle_part.empty())
        for (const auto& uses : crowded) {
            std::map<int, std::vector<EdgeUse>> of_part;
            for (const EdgeUse& use : without_partner(uses, sets))
                of_part[mesh.triangle_part[use.triangle]].push_back(use);
            for (const auto& [part, own] : of_part)
                if (excess(own) == 0) join_wedges(mesh, own, inside_out, joiner(sets));
        }
    DisjointSets by_order = sets;
    for (const auto& uses : crowded) {
        if (const auto left = without_partner(uses, sets); !left.empty())
            join_wedges(mesh, left, inside_out, joiner(sets));
        join_in_order(without_partner(uses, by_order), by_order);
    }
    // What is joined amiss at one edge joins bodies, or makes a sheet of their walls, at the next.
    std::vector<int> shell, other;
    const int count = by_order.number_sets(shell), other_count = sets.number_sets(other);
    if (!crowded.empty() && solid_count(mesh, other, other_count) > solid_count(mesh, shell, count))
        return other;
    return shell;
}

TriMesh split_fans(const TriMesh& mesh) {
    DisjointSets fans(3 * mesh.triangle.size());
    const auto join = [&](const EdgeUse& a, const EdgeUse& b) {
        fans.unite(3 * a.triangle + a.side, 3 * b.triangle + (b.side + 1) % 3);
        fans.unite(3 * a.triangle + (a.side + 1) % 3, 3 * b.triangle + b.side);
    };
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()),
                  [&](std::span<const EdgeUse> uses) {
                      if (excess(uses) == 0) join_wedges(mesh, uses, false, join);
                  });
    std::vector<int> fan;
    TriMesh split;
    split.position.resize(fans.number_sets(fan));
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const Corners own = {fan[3 * t], fan[3 * t + 1], fan[3 * t + 2]};
        for (int k = 0; k < 3; ++k) split.position[own[k]] = mesh.position[mesh.triangle[t][k]];
        split.triangle.push_back(own);
    }
    return split;
}

std::vector<Shell> split_shells(const TriMesh& mesh, const std::vector<int>& shell, int count) {
    std::vector<Shell> shells(count);
    std::vector<std::vector<std::size_t>> triangles(count);
    for (std::size_t t = 0; t < shell.size(); ++t) triangles[shell[t]].push_back(t);
    std::vector<int> place(mesh.position.size(), -1);
    for (int s = 0; s < count; ++s) {
        TriMesh& part = shells[s].mesh;
        const auto pick = [&](const auto& from, auto& to) {
            if (from.empty()) return;
            for (const std::size_t t : triangles[s]) to.push_back(from[t]);
        };
        for_each_triangle_array(pick, mesh, part);
        std::vector<int> used;
        for (Corners& c : part.triangle)
            for (int& i : c) {
                if (place[i] < 0) {
                    place[i] = static_cast<int>(used.size());
                    used.push_back(i);
                }
                i = place[i];
            }
        for (const int i : used) {
            part.position.push_back(mesh.position[i]);
            if (!mesh.position_color.empty()) part.position_color.push_back(mesh.position_color[i]);
            place[i] = -1;
        }
        shells[s].box = box_of(part.position);
        shells[s].volume = signed_volume(part);
    }
    return shells;
}

TriMesh join_shells(const TriMesh& whole, const std::vector<const TriMesh*>& parts) {
    TriMesh mesh;
    mesh.uv = whole.uv;
    mesh.material = whole.material;
    mesh.part_name = whole.part_name;
    mesh.smooth_group_count = whole.smooth_group_count;
    mesh.smooth_normal = whole.smooth_normal;
    for (const TriMesh* part : parts) {
        const int base = static_cast<int>(mesh.position.size());
        const std::size_t first = mesh.triangle.size();
        const auto add = [](const auto& from, auto& to) {
            to.insert(to.end(), from.begin(), from.end());
        };
        add(part->position, mesh.position);
        add(part->position_color, mesh.position_color);
        for_each_triangle_array(add, *part, mesh);
        for (std::size_t t = first; t < mesh.triangle.size(); ++t)
            for (int& i : mesh.triangle[t]) i += base;
    }
    return mesh;
}

TriMesh dress_pieces(TriMesh pieces, const std::vector<int>& origin, const TriMesh& a,
                     const TriMesh& b, TriMesh& whole_mesh) {
    std::vector<Vec2>& uv = whole_mesh.uv;
    const bool has_normals = !whole_mesh.smooth_normal.empty();
    std::map<std::array<int, 4>, int> group;  // of new corners, by place and rounded normal
    const int in_a = static_cast<int>(a.triangle.size());
    if (!a.position_color.empty())
        pieces.position_color.assign(pieces.position.size(), Eigen::Vector3f::Ones());
    for (std::size_t t = 0; t < pieces.triangle.size(); ++t) {
        const TriMesh& from = origin[t] < in_a ? a : b;
        const int o = origin[t] < in_a ? origin[t] : origin[t] - in_a;
        if (!from.triangle_material.empty())
            pieces.triangle_material.push_back(from.triangle_material[o]);
        if (!from.triangle_part.empty()) pieces.triangle_part.push_back(from.triangle_part[o]);
        const Corners& c = from.triangle[o];
        const Vec3 &p0 = from.position[c[0]], &p1 = from.position[c[1]], &p2 = from.position[c[2]];
        const Vec3 normal = area_vector(from.position, c);
        const double whole = normal.squaredNorm();
        Corners corner_uv = {-1, -1, -1}, smooth = {-1, -1, -1};
        for (int k = 0; k < 3; ++k) {
            const int place = pieces.triangle[t][k];
            const Vec3& p = pieces.position[place];
            Vec3 share = Vec3(1, 1, 1) / 3;  // barycentric
            if (whole > 0)
                share =
                    Vec3((p2 - p1).cross(p - p1).dot(normal), (p0 - p2).cross(p - p2).dot(normal),
                         (p1 - p0).cross(p - p0).dot(normal)) /
                    whole;
            for (int j = 0; j < 3; ++j)
                if (p == from.position[c[j]]) share = Vec3::Unit(j);
            if (!pieces.position_color.empty())
                pieces.position_color[place] =
                    static_cast<float>(share[0]) * from.position_color[c[0]] +
                    static_cast<float>(share[1]) * from.position_color[c[1]] +
                    static_cast<float>(share[2]) * from.position_color[c[2]];
            if (has_normals) {
                const Corners& old = from.triangle_smooth[o];
                for (int j = 0; j < 3; ++j)
                    if (share[j] == 1) smooth[k] = old[j];
                if (smooth[k] < 0) {
                    Vec3 n = Vec3::Zero();
                    for (int j = 0; j < 3; ++j) n += share[j] * whole_mesh.smooth_normal[old[j]];
                    const auto step = [&](int axis) {
                        return static_cast<int>(std::lround(n[axis] * 1000));
                    };
                    const auto [at, is_new] =
                        group.emplace(std::array{place, step(0), step(1), step(2)},
                                      whole_mesh.smooth_group_count);
                    if (is_new) {
                        ++whole_mesh.smooth_group_count;
                        whole_mesh.smooth_normal.push_back(n);
                    }
                    smooth[k] = at->second;
                }
            }
            if (from.triangle_uv.empty()) continue;
            const Corners& old = from.triangle_uv[o];
            for (int j = 0; j < 3; ++j)
                if (share[j] == 1) corner_uv[k] = old[j];
            if (corner_uv[k] < 0 && std::min({old[0], old[1], old[2]}) >= 0) {
                corner_uv[k] = static_cast<int>(uv.size());
                uv.push_back(share[0] * uv[old[0]] + share[1] * uv[old[1]] + share[2] * uv[old[2]]);
            }
        }
        if (!from.triangle_uv.empty()) pieces.triangle_uv.push_back(corner_uv);
        if (has_normals) pieces.triangle_smooth.push_back(smooth);
    }
    return pieces;
}

void turn_over(Shell& shell) {
    for (std::size_t t = 0; t < shell.mesh.triangle.size(); ++t) flip_triangle(shell.mesh, t);
    shell.volume = -shell.volume;
    shell.tree.reset();
}

}  // namespace swage
