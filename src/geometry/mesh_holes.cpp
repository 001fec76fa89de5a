// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_holes.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/error.h"
#include "geometry/edges.h"
#include "geometry/mesh_edit.h"
#include "geometry/mesh_repair_cgal.h"
#include "geometry/mesh_shells.h"

namespace swage {

namespace {

// Of a shell's area after filling, to count as a body with holes.
constexpr double kMostFilled = 0.4;
constexpr double kMostLeftOut = 0.25;  // of all area, in open sheets

using Outline = std::vector<EdgeUse>;

// Border edges of each shell, as outlines that run around the holes. Where shells meet at a corner
// of both their borders, each outline keeps to its own.
std::vector<Outline> outlines(const TriMesh& mesh, const std::vector<int>& shell_of) {
    // A hole's outline runs against the triangles beside it.
    const auto start = [](const EdgeUse& e) { return e.forward ? e.high : e.low; };
    const auto goal = [](const EdgeUse& e) { return e.forward ? e.low : e.high; };
    std::multimap<std::pair<int, int>, EdgeUse> leaving;  // by shell and start
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        if (uses.size() != 1) return;
        leaving.emplace(std::pair(shell_of[uses[0].triangle], start(uses[0])), uses[0]);
    });
    std::vector<Outline> loops;
    while (!leaving.empty()) {
        Outline path;
        std::map<int, std::size_t> visited;  // position: its place in the path
        const int shell = leaving.begin()->first.first;
        for (int at = leaving.begin()->first.second;;) {
            const auto next = leaving.find(std::pair(shell, at));
            if (next == leaving.end()) break;  // no loop: the border does not close
            visited[at] = path.size();
            path.push_back(next->second);
            leaving.erase(next);
            at = goal(path.back());
            const auto seen = visited.find(at);
            if (seen == visited.end()) continue;
            const auto from = path.begin() + static_cast<std::ptrdiff_t>(seen->second);
            loops.emplace_back(from, path.end());
            for (auto e = from; e != path.end(); ++e) visited.erase(start(*e));
            path.erase(from, path.end());
            if (path.empty()) break;
        }
    }
    return loops;
}

// What closes a hole.
struct Filling {
    int shell;
    std::vector<int> place;         // positions around the hole
    std::vector<Corners> triangle;  // of these; empty: it cannot be closed
    std::size_t like;               // a triangle beside it
    double area = 0;
};

Filling filling_of(const TriMesh& mesh, const std::vector<int>& shell, const Outline& hole) {
    Filling filling;
    filling.shell = shell[hole[0].triangle];
    filling.like = static_cast<std::size_t>(hole[0].triangle);
    std::vector<Vec3> point;
    for (const EdgeUse& e : hole) {
        filling.place.push_back(e.forward ? e.high : e.low);
        point.push_back(mesh.position[filling.place.back()]);
    }
    filling.triangle = fill_outline(point);
    for (const Corners& c : filling.triangle) filling.area += 0.5 * area_vector(point, c).norm();
    return filling;
}

void add_filling(const Filling& filling, TriMesh& mesh) {
    const std::vector<int>& place = filling.place;
    const int group = mesh.smooth_group_count;
    if (!mesh.triangle_smooth.empty()) mesh.smooth_group_count += static_cast<int>(place.size());
    for (const Corners& c : filling.triangle) {
        add_triangle(mesh, {place[c[0]], place[c[1]], place[c[2]]}, filling.like,
                     {group + c[0], group + c[1], group + c[2]});
    }
}

struct ShellArea {
    double area = 0, filled = 0;  // as given; of what closes its holes
    std::size_t triangles = 0;

    double filled_share() const { return filled > 0 ? filled / (area + filled) : 0; }
    // What would be closed by little less than its own area once more.
    bool is_sheet() const { return filled_share() > kMostFilled; }
};

std::vector<ShellArea> measured_shells(const TriMesh& mesh, const std::vector<int>& shell_of,
                                       const std::vector<Filling>& fillings) {
    const int count =
        shell_of.empty() ? 0 : *std::max_element(shell_of.begin(), shell_of.end()) + 1;
    std::vector<ShellArea> shells(count);
    for (std::size_t t = 0; t < shell_of.size(); ++t) {
        ShellArea& shell = shells[shell_of[t]];
        shell.area += 0.5 * area_vector(mesh.position, mesh.triangle[t]).norm();
        ++shell.triangles;
    }
    for (const Filling& f : fillings) shells[f.shell].filled += f.area;
    return shells;
}

}  // namespace

HolesClosed close_holes(TriMesh& mesh) {
    const std::vector<int> shell_of = shells_of(mesh);
    std::vector<Filling> fillings;
    for (const Outline& hole : outlines(mesh, shell_of)) {
        fillings.push_back(filling_of(mesh, shell_of, hole));
    }
    const std::vector<ShellArea> shells = measured_shells(mesh, shell_of, fillings);
    HolesClosed done;
    double area = 0, filled = 0, sheet_area = 0, worst = 0;
    for (const ShellArea& shell : shells) {
        area += shell.area;
        if (!shell.is_sheet()) {
            filled += shell.filled;
            continue;
        }
        ++done.sheets;
        done.sheet_triangles += shell.triangles;
        sheet_area += shell.area;
        worst = std::max(worst, shell.filled_share());
    }
    if (sheet_area > kMostLeftOut * area)
        fail(ExitCode::mesh,
             "an open sheet encloses no volume: closing it would invent {:.0f} % of its "
             "surface; give it thickness first (in Blender: the Solidify modifier), or close it",
             100 * worst);
    for (const Filling& filling : fillings) {
        if (shells[filling.shell].is_sheet()) continue;
        if (filling.triangle.empty()) {
            ++done.failed;
            continue;
        }
        add_filling(filling, mesh);
        ++done.holes;
        done.edges += filling.place.size();
        done.triangles += filling.triangle.size();
    }
    done.share = filled / (area + filled);
    done.sheet_share = sheet_area / area;
    if (done.sheets > 0) {
        std::vector<char> keep(mesh.triangle.size(), 1);
        for (std::size_t t = 0; t < shell_of.size(); ++t) {
            keep[t] = !shells[shell_of[t]].is_sheet();
        }
        keep_triangles(mesh, keep);
    }
    return done;
}

}  // namespace swage
