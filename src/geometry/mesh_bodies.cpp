// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_bodies.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_edit.h"
#include "geometry/mesh_repair_cgal.h"
#include "geometry/mesh_shells.h"
#include "geometry/mesh_unite.h"

namespace swage {

namespace {

constexpr std::size_t kMostClose = 1'000'000;    // pairs of shells with overlapping boxes
constexpr std::size_t kMostMeeting = 5000;       // pairs of shells that cross or touch
constexpr std::size_t kMostLooked = 50'000'000;  // pairs of triangles with overlapping boxes
constexpr double kOnSurface = 1e-6;              // of a shell's size: no further from it

// Whether any of a few vertices of a lies well inside b.
bool enters(const Shell& a, Shell& b) {
    const std::size_t step = std::max<std::size_t>(1, a.mesh.position.size() / 200);
    for (std::size_t i = 0; i < a.mesh.position.size(); i += step)
        if (std::abs(b.winding(a.mesh.position[i])) > 0.75) return true;
    return false;
}

bool lies_in(const Box& in, const Box& out) {
    return out.contains(in.low) && out.contains(in.high);
}

// Whether a, which meets b, lies in it all the same: a part of it within, none without.
bool touches_from_within(const Shell& a, Shell& b) {
    const double gap = kOnSurface * b.box.size().norm();
    if (!lies_in(a.box, b.box.widened(gap))) return false;
    bool within = false;
    const auto look = [&](const Vec3& point) {
        const bool inside = std::abs(b.winding(point)) > 0.5;
        if (inside && within) return true;
        const bool on_surface = b.tree->distance(point) <= gap;
        within = within || (inside && !on_surface);
        return inside || on_surface;
    };
    for (const Vec3& p : a.mesh.position)
        if (!look(p)) return false;
    for (const Corners& t : a.mesh.triangle)
        if (!look((a.mesh.position[t[0]] + a.mesh.position[t[1]] + a.mesh.position[t[2]]) / 3))
            return false;
    return within;
}

class Settler {
  public:
    Settler(TriMesh& mesh, double crease_angle, std::vector<std::string>& account)
        : mesh_(mesh), crease_angle_(crease_angle), account_(account) {}

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
        if (!mesh_.smooth_normal.empty()) keep_smooth_normals(mesh_);
        shells_ = split_shells(mesh_, shell, count);
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
        mesh_ = join_shells(mesh_, parts);
        if (united_) {
            mesh_.triangle_polygon.clear();
            if (mesh_.smooth_normal.empty()) smooth_by_crease_angle(mesh_, crease_angle_);
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
                 "the surface is closed but encloses no volume: a sheet with two sides; give it "
                 "thickness first (in Blender: the Solidify modifier)");
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
                if (a.box.overlaps(b.box))
                    close.emplace_back(std::min(by_x[i], by_x[j]), std::max(by_x[i], by_x[j]));
                if (close.size() > kMostClose)
                    return fmt::format(
                        "more than {} pairs of its parts are so close that one may be inside the "
                        "other",
                        kMostClose);
            }
        std::sort(close.begin(), close.end());
        std::vector<int> of;
        const TriMesh near = triangles_near_others(close, of);
        const auto meeting = parts_that_meet(near, of, kMostLooked);
        if (!meeting) return "its parts are too closely interleaved to tell where they meet";
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
                                 [&](int other) { return box.overlaps(shells_[other].box); }))
                    continue;
                near.triangle.push_back({t[0] + base, t[1] + base, t[2] + base});
                of.push_back(static_cast<int>(s));
            }
        }
        return near;
    }

    void find_nesting() {
        around_.resize(shells_.size());
        const auto size = [&](int s) { return std::abs(shells_[s].volume); };
        const auto consider = [&](int inner, int outer) {
            if (lies_in(shells_[inner].box, shells_[outer].box) &&
                std::abs(shells_[outer].winding(shells_[inner].mesh.position[0])) >= 0.5)
                around_[inner].push_back(outer);
        };
        for (const auto& [a, b] : apart_) {
            consider(a, b);
            consider(b, a);
        }
        // A cavity may touch the wall it is in.
        for (const auto& [a, b] : meeting_) {
            if ((shells_[a].volume > 0) == (shells_[b].volume > 0) || size(a) == size(b)) continue;
            const int inner = size(a) < size(b) ? a : b, outer = a + b - inner;
            if (touches_from_within(shells_[inner], shells_[outer]))
                around_[inner].push_back(outer);
        }
        for (std::vector<int>& around : around_)
            std::sort(around.begin(), around.end(),
                      [&](int a, int b) { return size(a) != size(b) ? size(a) < size(b) : a < b; });
    }

    int root_of(int s) const {
        while (!around_[s].empty()) s = around_[s].front();
        return s;
    }

    void turn_outward() {
        std::size_t bodies = 0, turned = 0;
        const int count = static_cast<int>(shells_.size());
        std::vector<char> turn(count, 0);
        for (int s = 0; s < count; ++s)
            if (around_[s].empty()) {
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

    bool outward(int s) const { return shells_[s].volume > 0; }

    // A cavity is an inward shell where there is matter once; what is outward in matter is there
    // twice, unless a cavity's wall goes through it.
    void drop_contained() {
        std::size_t dropped = 0;
        double volume = 0;
        const int count = static_cast<int>(shells_.size());
        std::vector<int> matter(count, 0);
        for (int s = 0; s < count; ++s)
            for (const int up : around_[s]) matter[s] += outward(up) ? 1 : -1;
        dropped_.assign(count, 0);
        for (int s = 0; s < count; ++s) dropped_[s] = !outward(s) && matter[s] != 1;
        for (const auto& [a, b] : meeting_) {
            if (outward(a) && !outward(b) && !dropped_[b]) --matter[a];
            if (outward(b) && !outward(a) && !dropped_[a]) --matter[b];
        }
        for (int s = 0; s < count; ++s) {
            if (outward(s)) dropped_[s] = matter[s] >= 1;
            if (!dropped_[s]) continue;
            ++dropped;
            volume += std::abs(shells_[s].volume);
            shells_[s].mesh.triangle.clear();
        }
        if (dropped == 0) return;
        changed_ = true;
        account_.push_back(fmt::format(
            "left out {} inside others of the same orientation: that volume ({}) was counted twice",
            counted(dropped, "surface", "surfaces"), volume_text(volume)));
    }

    // The body that an inward shell is a cavity of; an outward one is its own.
    int body_of(int s) const {
        if (outward(s)) return s;
        for (const int up : around_[s])
            if (outward(up) && !dropped_[up]) return up;
        return s;
    }

    int merged(int s) const {
        while (merged_[s] != s) s = merged_[s];
        return s;
    }

    bool unite_crossing() {
        const int count = static_cast<int>(shells_.size());
        merged_.resize(count);
        std::iota(merged_.begin(), merged_.end(), 0);
        std::vector<std::pair<int, int>> cavities, bodies;
        for (const auto& [a, b] : meeting_) {
            if (dropped_[a] || dropped_[b]) continue;
            if (body_of(a) != body_of(b)) {
                bodies.emplace_back(a, b);
            } else if (!outward(a) && !outward(b)) {
                cavities.emplace_back(a, b);
            }
        }
        // As bodies in the place of matter.
        std::vector<int> turned;
        for (const auto& [a, b] : cavities)
            for (const int s : {a, b})
                if (!outward(s)) {
                    turned.push_back(s);
                    turn_over(shells_[s]);
                }
        if (!unite_along(cavities, "crossing cavity", "crossing cavities")) return false;
        for (const int s : turned) turn_over(shells_[s]);

        gather_cavities(bodies);
        return unite_along(bodies, "crossing body", "crossing bodies");
    }

    // Into the meshes of the bodies they are in, where those meet others.
    void gather_cavities(const std::vector<std::pair<int, int>>& bodies) {
        const int count = static_cast<int>(shells_.size());
        std::vector<char> meets(count, 0);
        for (const auto& [a, b] : bodies) meets[body_of(a)] = meets[body_of(b)] = 1;
        std::vector<std::vector<int>> cavities(count);
        for (int s = 0; s < count; ++s) {
            const int body = body_of(s);
            if (body != s && meets[body] && !dropped_[s] && merged_[s] == s)
                cavities[body].push_back(s);
        }
        for (int body = 0; body < count; ++body) {
            if (cavities[body].empty()) continue;
            Shell& whole = shells_[body];
            std::vector<const TriMesh*> parts = {&whole.mesh};
            for (const int s : cavities[body]) parts.push_back(&shells_[s].mesh);
            whole.mesh = join_shells(mesh_, parts);
            whole.tree.reset();
            for (const int s : cavities[body]) {
                whole.volume += shells_[s].volume;
                shells_[s].mesh.triangle.clear();
                merged_[s] = body;
            }
        }
    }

    // Small ones first, so that what has grown is cut anew as seldom as can be.
    bool unite_along(const std::vector<std::pair<int, int>>& pairs, const char* one,
                     const char* many) {
        using Next = std::tuple<std::size_t, int, int>;  // how many triangles, of which two
        std::priority_queue<Next, std::vector<Next>, std::greater<>> queue;
        const auto next_of = [&](int a, int b) {
            const auto [x, y] = std::minmax({merged(a), merged(b)});
            return Next(shells_[x].mesh.triangle.size() + shells_[y].mesh.triangle.size(), x, y);
        };
        for (const auto& [a, b] : pairs) queue.push(next_of(a, b));
        std::vector<char> took_part(shells_.size(), 0);
        double shared = 0;
        while (!queue.empty()) {
            const auto next = queue.top();
            queue.pop();
            const auto [size, x, y] = next;
            if (merged(x) == merged(y)) continue;
            if (const Next now = next_of(x, y); now != next) {
                queue.push(now);
                continue;
            }
            const double sum = shells_[x].volume + shells_[y].volume;
            if (!unite_two(x, y)) return false;
            if (merged_[y] != x) continue;
            took_part[x] = took_part[y] = 1;
            shared += sum - shells_[x].volume;
        }
        const auto count =
            static_cast<std::size_t>(std::count(took_part.begin(), took_part.end(), 1));
        if (count > 0)
            account_.push_back(fmt::format("united {}: a volume of {} was counted more than once",
                                           counted(count, one, many), volume_text(shared)));
        return true;
    }

    // False where they cross and cannot be united.
    bool unite_two(int x, int y) {
        Shell &a = shells_[x], &b = shells_[y];
        TriMesh united;
        std::vector<int> origin;
        const double sum = a.volume + b.volume;
        double least = 1e-9 * std::abs(sum);
        if (!unite(a.mesh, b.mesh, united, origin)) {
            const double* grown = std::find_if(
                std::begin(kGrown), std::end(kGrown),
                [&](double by) { return unite_grown(a.mesh, b.mesh, by, united, origin); });
            if (grown == std::end(kGrown)) return !enters(a, b) && !enters(b, a);
            Box both = a.box;
            both.grow(b.box);
            const double smaller = std::min(a.box.size().norm(), b.box.size().norm());
            least = 10 * *grown * both.size().norm() * smaller * smaller;
        }
        const double volume = signed_volume(united);
        // Nothing in common: they only touch, and stay as they are.
        if (std::abs(volume - sum) <= least) return true;
        a.mesh = dress_pieces(std::move(united), origin, a.mesh, b.mesh, mesh_);
        a.volume = volume;
        a.box.grow(b.box);
        a.tree.reset();
        b.mesh.triangle.clear();
        merged_[y] = x;
        changed_ = united_ = true;
        return true;
    }

    TriMesh& mesh_;
    double crease_angle_;
    std::vector<std::string>& account_;
    std::vector<Shell> shells_;
    std::vector<std::pair<int, int>> meeting_, apart_;
    std::vector<std::vector<int>> around_;  // the shells around each, the smallest first
    std::vector<char> dropped_;
    std::vector<int> merged_;  // the shell that each is a part of now, or itself
    bool changed_ = false, united_ = false;
};

}  // namespace

std::optional<std::string> settle_bodies(TriMesh& mesh, double crease_angle,
                                         std::vector<std::string>& account) {
    return Settler(mesh, crease_angle, account).run();
}

}  // namespace swage
