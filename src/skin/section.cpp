// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: L. P. Chew, "Constrained Delaunay triangulations", 1989, as CGAL has them.
#include "skin/section.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "skin/flat_segment.h"

namespace swage {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;  // point id
using FaceInfo = CGAL::Triangulation_face_base_with_info_2<int, Kernel>;      // winding
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel, FaceInfo>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                               CGAL::No_constraint_intersection_tag>;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;
using Point = Kernel::Point_2;

constexpr int kUnknown = std::numeric_limits<int>::min();

using Direction = std::map<std::pair<int, int>, int>;  // ends, ascending -> net times ascending

// How often the segments wind around each face, from 0 outside; false on a contradiction.
bool wind(Triangulation& cdt, const Direction& direction) {
    for (Face f : cdt.all_face_handles()) f->info() = kUnknown;
    std::vector<Face> open = {cdt.infinite_face()};
    open.front()->info() = 0;
    while (!open.empty()) {
        const Face face = open.back();
        open.pop_back();
        for (int side = 0; side < 3; ++side) {
            const Face next = face->neighbor(side);
            int winding = face->info();
            if (face->is_constrained(side)) {
                // The face lies to the left of its own edges.
                const int from = face->vertex(Triangulation::ccw(side))->info();
                const int to = face->vertex(Triangulation::cw(side))->info();
                const int net = direction.at({std::min(from, to), std::max(from, to)});
                winding -= from < to ? net : -net;
            }
            if (winding < 0 || winding > 1) return false;
            if (next->info() == kUnknown) {
                next->info() = winding;
                open.push_back(next);
            } else if (next->info() != winding) {
                return false;
            }
        }
    }
    return true;
}

double distance_to_segments(const Section& section, const Vec2& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto* lines : {&section.segment, &section.line}) {
        for (const auto& [a, b] : *lines) {
            least = std::min(least, distance2_to_segment(p, section.point[a], section.point[b]));
        }
    }
    return std::sqrt(least);
}

// The wishes, then rows of points set off by half a spacing, all at a distance from the segments
// and from each other.
std::vector<Vec2> inner_points(const Section& section, const Triangulation& cdt) {
    std::vector<Vec2> inner;
    Face hint;
    const auto offer = [&](const Vec2& p, double clearance) {
        hint = cdt.locate(Point(p[0], p[1]), hint);
        if (cdt.is_infinite(hint) || hint->info() != 1) return;
        if (distance_to_segments(section, p) < clearance) return;
        inner.push_back(p);
    };
    const double a = section.spacing;
    std::size_t wishes = 0;
    const auto is_free = [&](const Vec2& p, double reach) {
        return std::none_of(inner.begin(), inner.begin() + wishes, [&](const Vec2& wish) {
            return (p - wish).squaredNorm() < reach * reach;
        });
    };
    for (const Vec2& p : section.wish) {  // a blade that comes back asks for the same ones again
        if (is_free(p, 0.2 * a)) offer(p, 0.3 * a);
        wishes = inner.size();
    }

    Vec2 low = section.point.front(), high = low;
    for (const Vec2& p : section.point) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const double rise = a * std::sqrt(0.75);
    for (int j = 0; low[1] + j * rise <= high[1]; ++j) {
        for (int i = 0; low[0] + (i + 0.5 * (j & 1)) * a <= high[0]; ++i) {
            const Vec2 p(low[0] + (i + 0.5 * (j & 1)) * a, low[1] + j * rise);
            if (is_free(p, 0.5 * a)) offer(p, 0.45 * a);
        }
    }
    return inner;
}

}  // namespace

std::optional<SectionTriangles> fill_section(const Section& section) {
    if (section.segment.empty()) return std::nullopt;
    Triangulation cdt;
    std::vector<Vertex> vertex(section.point.size());
    Face hint;
    for (std::size_t n = 0; n < section.point.size(); ++n) {
        const std::size_t before = cdt.number_of_vertices();
        vertex[n] = cdt.insert(Point(section.point[n][0], section.point[n][1]), hint);
        if (cdt.number_of_vertices() == before) return std::nullopt;
        vertex[n]->info() = static_cast<int>(n);
        hint = vertex[n]->face();
    }
    Direction direction;
    try {
        for (const auto& [a, b] : section.segment) {
            cdt.insert_constraint(vertex[a], vertex[b]);
            direction[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
        for (const auto& [a, b] : section.line) {  // on both sides of which is as much
            cdt.insert_constraint(vertex[a], vertex[b]);
            direction[{std::min(a, b), std::max(a, b)}] += 0;
        }
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
        return std::nullopt;
    }
    for (const auto& [ends, net] : direction) {
        if (!cdt.is_edge(vertex[ends.first], vertex[ends.second])) return std::nullopt;
    }
    if (!wind(cdt, direction)) return std::nullopt;

    SectionTriangles result;
    result.added = inner_points(section, cdt);
    hint = vertex.back()->face();  // constraints have put others in place of the one it was
    for (std::size_t n = 0; n < result.added.size(); ++n) {
        const Vertex v = cdt.insert(Point(result.added[n][0], result.added[n][1]), hint);
        v->info() = static_cast<int>(section.point.size() + n);
        hint = v->face();
    }
    if (!wind(cdt, direction)) return std::nullopt;
    for (Face f : cdt.finite_face_handles()) {
        if (f->info() == 1) {
            result.triangle.push_back(
                {f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
        }
    }
    return result;
}

}  // namespace swage
