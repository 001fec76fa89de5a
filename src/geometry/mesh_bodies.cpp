// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_bodies.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "base/error.h"
#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_edit.h"
#include "geometry/mesh_repair_cgal.h"
#include "geometry/triangle_tree.h"

namespace swage {

namespace {

constexpr std::size_t kMostClose = 1'000'000;    // pairs of shells with overlapping boxes
constexpr std::size_t kMostMeeting = 5000;       // pairs of shells that cross or touch
constexpr std::size_t kMostLooked = 50'000'000;  // pairs of triangles with overlapping boxes
constexpr double kCreaseAngle = 40 * kPi / 180;

std::string counted(std::size_t count, const char* one, const char* many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
}

bool overlap(const Box& a, const Box& b) {
    return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

struct Shell {
    TriMesh mesh;
    Box box;
    double volume = 0;
    std::unique_ptr<TriangleTree> tree;  // made when first asked for
    int inside = -1;                     // the smallest shell around this one

    double winding(const Vec3& point) {
        if (tree == nullptr) tree = std::make_unique<TriangleTree>(mesh);
        return tree->winding_number(point);
    }
};

std::vector<Shell> split(const TriMesh& mesh, const std::vector<int>& shell, int count) {
    std::vector<Shell> shells(count);
    std::vector<std::vector<std::size_t>> triangles(count);
    for (std::size_t t = 0; t < shell.size(); ++t) triangles[shell[t]].push_back(t);
    std::vector<int> place(mesh.position.size(), -1);
    for (int s = 0; s < count; ++s) {
        // Attributes keep their numbers; only positions are made few, so that many shells are
        // cheap.
        TriMesh& part = shells[s].mesh;
        const auto pick = [&](const auto& from, auto& to) {
            if (from.empty()) return;
            for (const std::size_t t : triangles[s]) to.push_back(from[t]);
        };
        pick(mesh.triangle, part.triangle);
        pick(mesh.triangle_uv, part.triangle_uv);
        pick(mesh.triangle_smooth, part.triangle_smooth);
        pick(mesh.triangle_polygon, part.triangle_polygon);
        pick(mesh.triangle_material, part.triangle_material);
        pick(mesh.triangle_part, part.triangle_part);
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

// Puts shells together again. Their attributes still count in the whole mesh's lists.
TriMesh join(const TriMesh& whole, const std::vector<const TriMesh*>& parts) {
    TriMesh mesh;
    mesh.uv = whole.uv;
    mesh.material = whole.material;
    mesh.part_name = whole.part_name;
    mesh.smooth_group_count = whole.smooth_group_count;
    for (const TriMesh* part : parts) {
        const int base = static_cast<int>(mesh.position.size());
        const auto add = [](const auto& from, auto& to) {
            to.insert(to.end(), from.begin(), from.end());
        };
        add(part->position, mesh.position);
        add(part->position_color, mesh.position_color);
        for (Corners c : part->triangle) {
            for (int& i : c) i += base;
            mesh.triangle.push_back(c);
        }
        add(part->triangle_uv, mesh.triangle_uv);
        add(part->triangle_smooth, mesh.triangle_smooth);
        add(part->triangle_polygon, mesh.triangle_polygon);
        add(part->triangle_material, mesh.triangle_material);
        add(part->triangle_part, mesh.triangle_part);
    }
    return mesh;
}

// Gives the pieces of a union what the triangles they come from had. `uv` is the list of the whole
// mesh; new entries go there.
TriMesh dress(TriMesh pieces, const std::vector<int>& origin, const TriMesh& a, const TriMesh& b,
              std::vector<Vec2>& uv) {
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
        const Vec3 normal = (p1 - p0).cross(p2 - p0);
        const double whole = normal.squaredNorm();
        Corners corner_uv = {-1, -1, -1};
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
    }
    return pieces;
}

void turn_over(Shell& shell) {
    for (std::size_t t = 0; t < shell.mesh.triangle.size(); ++t) flip_triangle(shell.mesh, t);
    shell.volume = -shell.volume;
    shell.tree.reset();
}

// Whether any of a few vertices of a lies well inside b.
bool enters(const Shell& a, Shell& b) {
    const std::size_t step = std::max<std::size_t>(1, a.mesh.position.size() / 200);
    for (std::size_t i = 0; i < a.mesh.position.size(); i += step)
        if (std::abs(b.winding(a.mesh.position[i])) > 0.75) return true;
    return false;
}

class Settler {
  public:
    Settler(TriMesh& mesh, std::vector<std::string>& account) : mesh_(mesh), account_(account) {}

    // Why it could not be done; the mesh is then as it was.
    std::optional<std::string> run() {
        const std::vector<int> shell = shells_of(mesh_);
        const int count = 1 + *std::max_element(shell.begin(), shell.end());
        if (count == 1) {  // by far the most frequent
            if (signed_volume(mesh_) < 0) {
                for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) flip_triangle(mesh_, t);
                account_.emplace_back("turned the whole surface: it was inside out");
            }
            return std::nullopt;
        }
        shells_ = split(mesh_, shell, count);
        drop_flat();
        if (auto reason = find_pairs()) return reason;
        find_nesting();
        turn_outward();
        drop_contained();
        if (!unite_crossing()) return "its parts cross each other and cannot be united";
        if (!changed_) return std::nullopt;
        std::vector<const TriMesh*> parts;
        for (const Shell& s : shells_)
            if (!s.mesh.triangle.empty()) parts.push_back(&s.mesh);
        mesh_ = join(mesh_, parts);
        if (united_) {
            mesh_.triangle_polygon.clear();
            smooth_by_crease_angle(mesh_, kCreaseAngle);
        }
        return std::nullopt;
    }

  private:
    // Closed shells without volume (a sheet given twice, back to back).
    void drop_flat() {
        std::size_t dropped = 0, triangles = 0;
        for (Shell& s : shells_) {
            const double size = s.box.size().norm();
            if (std::abs(s.volume) > 1e-12 * size * size * size) continue;
            ++dropped;
            triangles += s.mesh.triangle.size();
            s.mesh.triangle.clear();
        }
        if (dropped == 0) return;
        if (dropped == shells_.size())
            fail(ExitCode::mesh,
                 "the surface is closed and encloses no volume: a sheet given from "
                 "both sides; give it thickness first (in Blender: the Solidify modifier)");
        std::erase_if(shells_, [](const Shell& s) { return s.mesh.triangle.empty(); });
        changed_ = true;
        account_.push_back(fmt::format("left out {} of {} that enclose nothing",
                                       counted(dropped, "closed sheet", "closed sheets"),
                                       counted(triangles, "triangle", "triangles")));
    }

    std::optional<std::string> find_pairs() {
        const int count = static_cast<int>(shells_.size());
        std::vector<int> by_x(count);
        std::iota(by_x.begin(), by_x.end(), 0);
        std::sort(by_x.begin(), by_x.end(), [&](int a, int b) {
            const double ax = shells_[a].box.low.x(), bx = shells_[b].box.low.x();
            return ax != bx ? ax < bx : a < b;
        });
        std::vector<std::pair<int, int>> close;
        for (int i = 0; i < count; ++i)
            for (int j = i + 1; j < count; ++j) {
                const Shell &a = shells_[by_x[i]], &b = shells_[by_x[j]];
                if (b.box.low.x() > a.box.high.x()) break;
                if (overlap(a.box, b.box))
                    close.emplace_back(std::min(by_x[i], by_x[j]), std::max(by_x[i], by_x[j]));
                if (close.size() > kMostClose)
                    return fmt::format(
                        "more than {} pairs of its parts lie so close that one may be in the other",
                        kMostClose);
            }
        std::sort(close.begin(), close.end());
        std::vector<int> of;
        const TriMesh near = triangles_near_others(close, of);
        const auto meeting = parts_that_meet(near, of, kMostLooked);
        if (!meeting) return "its parts run too closely among each other to tell where they meet";
        if (meeting->size() > kMostMeeting)
            return fmt::format("more than {} pairs of its parts cross or touch each other",
                               kMostMeeting);
        meeting_ = *meeting;
        std::set_difference(close.begin(), close.end(), meeting_.begin(), meeting_.end(),
                            std::back_inserter(apart_));
        return std::nullopt;
    }

    // Those in the box of another shell, of which alone they can meet one; `of` gets their shells.
    TriMesh triangles_near_others(const std::vector<std::pair<int, int>>& close,
                                  std::vector<int>& of) const {
        std::vector<std::vector<int>> others(shells_.size());
        for (const auto& [a, b] : close) {
            others[a].push_back(b);
            others[b].push_back(a);
        }
        TriMesh near;
        for (std::size_t s = 0; s < shells_.size(); ++s) {
            if (others[s].empty()) continue;
            const TriMesh& mesh = shells_[s].mesh;
            const int base = static_cast<int>(near.position.size());
            near.position.insert(near.position.end(), mesh.position.begin(), mesh.position.end());
            for (const Corners& t : mesh.triangle) {
                Box box;
                for (const int i : t) box.grow(mesh.position[i]);
                if (std::none_of(others[s].begin(), others[s].end(),
                                 [&](int other) { return overlap(box, shells_[other].box); }))
                    continue;
                near.triangle.push_back({t[0] + base, t[1] + base, t[2] + base});
                of.push_back(static_cast<int>(s));
            }
        }
        return near;
    }

    void find_nesting() {
        const auto consider = [&](int inner, int outer) {
            const Box &in = shells_[inner].box, &out = shells_[outer].box;
            if (!((in.low.array() >= out.low.array()).all() &&
                  (in.high.array() <= out.high.array()).all()))
                return;
            if (std::abs(shells_[outer].winding(shells_[inner].mesh.position[0])) < 0.5) return;
            int& known = shells_[inner].inside;
            if (known < 0 || std::abs(shells_[outer].volume) < std::abs(shells_[known].volume))
                known = outer;
        };
        for (const auto& [a, b] : apart_) {
            consider(a, b);
            consider(b, a);
        }
    }

    int root_of(int s) const {
        while (shells_[s].inside >= 0) s = shells_[s].inside;
        return s;
    }

    void turn_outward() {
        std::size_t bodies = 0, turned = 0;
        const int count = static_cast<int>(shells_.size());
        std::vector<char> turn(count, 0);
        for (int s = 0; s < count; ++s)
            if (shells_[s].inside < 0) {
                ++bodies;
                turn[s] = shells_[s].volume < 0;
                turned += turn[s];
            }
        for (int s = 0; s < count; ++s)
            if (turn[root_of(s)]) turn_over(shells_[s]);
        if (turned == 0) return;
        changed_ = true;
        account_.push_back(turned == bodies
                               ? std::string("turned the whole surface: it was inside out")
                               : fmt::format("turned {} of {}: inside out", turned,
                                             counted(bodies, "body", "bodies")));
    }

    // Only where the sense alternates with depth is a shell inside another a cavity (or an island
    // in one).
    void drop_contained() {
        std::size_t dropped = 0;
        double volume = 0;
        const int count = static_cast<int>(shells_.size());
        std::vector<char> drop(count, 0);
        for (int s = 0; s < count; ++s) {
            // Of the shells around, those that stay decide; walk up past dropped ones is not
            // needed: what is inside a dropped body is inside the one that swallowed it.
            int sum = 0;
            for (int up = shells_[s].inside; up >= 0; up = shells_[up].inside)
                sum += shells_[up].volume > 0 ? 1 : -1;
            const bool outward = shells_[s].volume > 0;
            drop[s] = (outward && sum >= 1) || (!outward && sum != 1);
        }
        for (int s = 0; s < count; ++s) {
            if (!drop[s]) continue;
            ++dropped;
            volume += std::abs(shells_[s].volume);
            shells_[s].mesh.triangle.clear();
        }
        if (dropped == 0) return;
        changed_ = true;
        account_.push_back(
            fmt::format("left out {} inside others of the same sense: that volume ({}) was "
                        "counted twice",
                        counted(dropped, "surface", "surfaces"), volume_text(volume)));
    }

    bool unite_crossing() {
        // Bodies: a root with its cavities.
        const int count = static_cast<int>(shells_.size());
        std::vector<int> body(count);
        for (int s = 0; s < count; ++s) body[s] = root_of(s);
        std::size_t unions = 0;
        double before = 0;
        for (const auto& [a, b] : meeting_) {
            if (shells_[a].mesh.triangle.empty() || shells_[b].mesh.triangle.empty()) continue;
            const auto current = [&](int s) {
                while (body[s] != s) s = body[s];
                return s;
            };
            const int x = current(body[a]), y = current(body[b]);
            if (x == y) continue;
            gather(x, body);
            gather(y, body);
            TriMesh united;
            std::vector<int> origin;
            const double sum = shells_[x].volume + shells_[y].volume;
            if (unite(shells_[x].mesh, shells_[y].mesh, united, origin)) {
                const double volume = signed_volume(united);
                // Nothing in common: they only touch, and stay as they are.
                if (std::abs(volume - sum) <= 1e-9 * std::abs(sum)) continue;
                shells_[x].mesh =
                    dress(std::move(united), origin, shells_[x].mesh, shells_[y].mesh, mesh_.uv);
                shells_[x].volume = volume;
                shells_[x].box.grow(shells_[y].box.low);
                shells_[x].box.grow(shells_[y].box.high);
                shells_[x].tree.reset();
                shells_[y].mesh.triangle.clear();
                body[y] = x;
                ++unions;
                before += sum - volume;
                changed_ = united_ = true;
            } else if (enters(shells_[x], shells_[y]) || enters(shells_[y], shells_[x])) {
                return false;
            }
        }
        if (unions > 0)
            account_.push_back(fmt::format("united {}: a volume of {} was counted more than once",
                                           counted(unions + 1, "crossing body", "crossing bodies"),
                                           volume_text(before)));
        return true;
    }

    // Moves the cavities of body x into its own mesh.
    void gather(int x, std::vector<int>& body) {
        std::vector<const TriMesh*> parts = {&shells_[x].mesh};
        std::vector<int> cavities;
        for (int s = 0; s < static_cast<int>(shells_.size()); ++s)
            if (s != x && root_of(s) == x && !shells_[s].mesh.triangle.empty()) {
                parts.push_back(&shells_[s].mesh);
                cavities.push_back(s);
            }
        if (cavities.empty()) return;
        shells_[x].mesh = join(mesh_, parts);
        for (const int s : cavities) {
            shells_[x].volume += shells_[s].volume;
            shells_[s].mesh.triangle.clear();
            body[s] = x;
        }
        shells_[x].tree.reset();
        changed_ = true;
    }

    TriMesh& mesh_;
    std::vector<std::string>& account_;
    std::vector<Shell> shells_;
    std::vector<std::pair<int, int>> meeting_, apart_;
    bool changed_ = false, united_ = false;
};

}  // namespace

std::vector<int> shells_of(const TriMesh& mesh) {
    DisjointSets sets(mesh.triangle.size());
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        for (std::size_t i = 1; i < uses.size(); ++i)
            sets.unite(uses[0].triangle, uses[i].triangle);
    });
    std::vector<int> shell;
    sets.number_sets(shell);
    return shell;
}

std::optional<std::string> settle_bodies(TriMesh& mesh, std::vector<std::string>& account) {
    return Settler(mesh, account).run();
}

}  // namespace swage
