// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"

namespace swage {

namespace {

constexpr double kNoArea = 1e-12;  // of the longest edge squared

bool is_degenerate(const TriMesh& mesh, const Corners& t) {
    if (has_repeated_corner(t)) return true;
    const Vec3 a = mesh.position[t[1]] - mesh.position[t[0]];
    const Vec3 b = mesh.position[t[2]] - mesh.position[t[0]];
    const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    return !(a.cross(b).norm() > kNoArea * longest);
}

std::size_t count_duplicates(const std::vector<Corners>& triangle) {
    std::vector<Corners> sorted = triangle;
    for (Corners& t : sorted) std::sort(t.begin(), t.end());
    std::sort(sorted.begin(), sorted.end());
    std::size_t count = 0;
    for (std::size_t i = 1; i < sorted.size(); ++i) count += sorted[i] == sorted[i - 1];
    return count;
}

void check_edges(const TriMesh& mesh, MeshReport& report) {
    DisjointSets fans(3 * mesh.triangle.size());
    bool odd = false;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        std::size_t forward = 0;
        for (const EdgeUse& use : uses) forward += use.forward;
        const std::size_t backward = uses.size() - forward;
        report.boundary_edges += uses.size() == 1;
        report.crowded_edges += uses.size() > 2;
        report.disagreeing_edges += std::max(forward, backward) - std::min(forward, backward) > 1;
        odd = odd || uses.size() % 2 == 1;
        for (std::size_t i = 1; i < uses.size(); ++i) {
            const EdgeUse &a = uses[i - 1], &b = uses[i];
            const int shift = a.forward == b.forward ? 0 : 1;
            const int b_low = 3 * b.triangle + (b.side + shift) % 3;
            const int b_high = 3 * b.triangle + (b.side + 1 - shift) % 3;
            fans.unite(3 * a.triangle + a.side, b_low);
            fans.unite(3 * a.triangle + (a.side + 1) % 3, b_high);
        }
    });
    report.watertight = !odd;
    report.oriented = report.disagreeing_edges == 0;

    std::vector<int> fan_at(mesh.position.size(), -1);
    std::vector<char> crowded(mesh.position.size(), 0);
    for (std::size_t c = 0; c < 3 * mesh.triangle.size(); ++c) {
        const Corners& t = mesh.triangle[c / 3];
        if (has_repeated_corner(t)) continue;
        const int place = t[c % 3];
        const int fan = fans.root(static_cast<int>(c));
        if (fan_at[place] >= 0 && fan_at[place] != fan) crowded[place] = 1;
        fan_at[place] = fan;
    }
    report.crowded_vertices =
        static_cast<std::size_t>(std::count(crowded.begin(), crowded.end(), 1));
    report.manifold = report.crowded_edges == 0 && report.crowded_vertices == 0;
}

// Places are welded, so that closed surfaces which touch share vertices, as the parts of what was
// cut do. They are told apart where none of their edges has an odd number of triangles of its own.
int count_components(const TriMesh& mesh, const Components& touching) {
    const std::vector<EdgeUse> uses = edge_uses(mesh.triangle, mesh.position.size());
    DisjointSets sets(mesh.triangle.size());
    for_each_edge(uses, [&](auto edge) {
        if (edge.size() == 2) sets.unite(edge[0].triangle, edge[1].triangle);
    });
    std::vector<int> shell;
    std::vector<int> first(static_cast<std::size_t>(sets.number_sets(shell)), -1);
    std::vector<int> shells(static_cast<std::size_t>(touching.count), 0);
    std::vector<char> is_closed(shells.size(), 1);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const int component = touching.triangle_component[t];
        if (has_repeated_corner(mesh.triangle[t])) is_closed[component] = 0;
        if (std::exchange(first[shell[t]], 0) < 0) ++shells[component];
    }
    for_each_edge(uses, [&](auto edge) {
        std::vector<int> beside;
        for (const EdgeUse& use : edge) beside.push_back(shell[use.triangle]);
        std::sort(beside.begin(), beside.end());
        for (auto one = beside.begin(), next = one; one != beside.end(); one = next) {
            next = std::upper_bound(one, beside.end(), *one);
            if ((next - one) % 2 == 1) {
                is_closed[touching.triangle_component[edge[0].triangle]] = 0;
            }
        }
    });
    int count = 0;
    for (std::size_t c = 0; c < shells.size(); ++c) count += is_closed[c] ? shells[c] : 1;
    return count;
}

void add_findings(MeshReport& report) {
    const auto say = [&](std::size_t count, const char* one, const char* many, const char* what) {
        if (count > 0) report.finding.push_back(counted(count, one, many) + what);
    };
    say(report.boundary_edges, "edge", "edges", " at the border of a hole or an open sheet");
    say(report.crowded_edges, "edge", "edges", " shared by more than two triangles");
    say(report.disagreeing_edges, "edge", "edges",
        " whose triangles disagree on which side is outside");
    if (report.crowded_edges == 0)
        say(report.crowded_vertices, "vertex", "vertices", " where separate surfaces touch");
    say(report.degenerate_triangles, "triangle", "triangles", " without area");
    say(report.duplicate_triangles, "triangle", "triangles", " present more than once");
    say(report.unreferenced_vertices, "vertex", "vertices", " that no triangle uses");
    if (report.watertight && report.oriented && report.volume < 0)
        report.finding.emplace_back("the surface is inside out");
    else
        say(static_cast<std::size_t>(report.inward_components), "closed surface", "closed surfaces",
            " facing inwards (a cavity, or inside out)");
}

}  // namespace

std::vector<double> component_volumes(const TriMesh& mesh, const Components& components) {
    return component_volumes(mesh, mesh.position, components);
}

std::vector<double> component_volumes(const TriMesh& mesh, const std::vector<Vec3>& position,
                                      const Components& components) {
    std::vector<double> volume(components.count, 0.0);
    std::vector<int> anchor(components.count, -1);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const int c = components.triangle_component[t];
        if (anchor[c] < 0) anchor[c] = mesh.triangle[t][0];
        const Vec3& o = position[anchor[c]];
        const Corners& k = mesh.triangle[t];
        volume[c] += (position[k[0]] - o).dot((position[k[1]] - o).cross(position[k[2]] - o)) / 6;
    }
    return volume;
}

MeshReport check_mesh(const TriMesh& mesh) {
    MeshReport report;
    report.vertices = mesh.position.size();
    report.triangles = mesh.triangle.size();
    report.polygons = mesh.triangle.size();
    for (std::size_t t = 1; t < mesh.triangle_polygon.size(); ++t)
        report.polygons -= mesh.triangle_polygon[t] == mesh.triangle_polygon[t - 1];
    report.materials = mesh.material.size();
    report.has_uv = !mesh.triangle_uv.empty();
    std::vector<char> used(mesh.position.size(), 0);
    for (const Corners& t : mesh.triangle) {
        report.degenerate_triangles += is_degenerate(mesh, t);
        for (const int i : t) {
            used[i] = 1;
            report.box.grow(mesh.position[i]);
        }
    }
    report.unreferenced_vertices =
        static_cast<std::size_t>(std::count(used.begin(), used.end(), 0));
    report.duplicate_triangles = count_duplicates(mesh.triangle);
    check_edges(mesh, report);
    const Components components = surface_components(mesh);
    report.components = report.manifold ? components.count : count_components(mesh, components);
    report.volume = signed_volume(mesh);
    report.area = surface_area(mesh);
    if (report.watertight && report.oriented)
        for (const double v : component_volumes(mesh, components))
            report.inward_components += v < 0;
    add_findings(report);
    return report;
}

namespace {

struct ShownUnit {
    double from;  // such sizes on
    const char* name;
    double factor;
};
constexpr ShownUnit kLengths[] = {
    {1e4, "km", 1e-3}, {1, "m", 1}, {1e-2, "cm", 1e2}, {1e-3, "mm", 1e3}, {0, "um", 1e6}};
constexpr ShownUnit kAreas[] = {
    {0.1, "m2", 1}, {1e-5, "cm2", 1e4}, {1e-9, "mm2", 1e6}, {0, "um2", 1e12}};
constexpr ShownUnit kVolumes[] = {
    {1e-3, "m3", 1}, {1e-8, "cm3", 1e6}, {1e-12, "mm3", 1e9}, {0, "um3", 1e18}};

// Nought is in metres.
const ShownUnit& unit_for(std::span<const ShownUnit> units, double value) {
    return *std::find_if(units.begin(), units.end() - 1, [&](const ShownUnit& unit) {
        return value == 0 ? unit.factor == 1 : std::abs(value) >= unit.from;
    });
}

std::string text_in(std::span<const ShownUnit> units, double value) {
    const ShownUnit& unit = unit_for(units, value);
    return fmt::format("{:.4g} {}", unit.factor * value, unit.name);
}

}  // namespace

std::string length_text(double metres) { return text_in(kLengths, metres); }
std::string volume_text(double cubic_metres) { return text_in(kVolumes, cubic_metres); }
std::string area_text(double square_metres) { return text_in(kAreas, square_metres); }

std::string summary_line(const MeshReport& report) {
    std::string state = "closed";
    if (!report.watertight) {
        state = report.boundary_edges > 0
                    ? fmt::format("open ({})",
                                  counted(report.boundary_edges, "border edge", "border edges"))
                    : "not closed";
    } else if (!report.oriented) {
        state = "closed, but its faces disagree on which side is outside";
    } else if (report.volume < 0) {
        state = "closed, inside out";
    }
    // All three sides in the unit that suits the longest.
    const Vec3 size = report.box.empty() ? Vec3(Vec3::Zero()) : report.box.size();
    const ShownUnit& unit = unit_for(kLengths, size.maxCoeff());
    std::string line = counted(report.vertices, "vertex", "vertices") + ", " +
                       counted(report.triangles, "triangle", "triangles");
    if (report.polygons != report.triangles)
        line += fmt::format(" ({})", counted(report.polygons, "polygon", "polygons"));
    line += ", " + counted(static_cast<std::size_t>(report.components), "component", "components");
    if (report.materials > 0) line += ", " + counted(report.materials, "material", "materials");
    if (report.has_uv) line += ", texture coordinates";
    return line + fmt::format(", {}, volume {}, box {:.4g} x {:.4g} x {:.4g} {}", state,
                              volume_text(report.volume), unit.factor * size.x(),
                              unit.factor * size.y(), unit.factor * size.z(), unit.name);
}

}  // namespace swage
