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

#include "base/portable_math.h"
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

// Of a band, that no coordinate comes near what a double holds: lengths along it in radii.
constexpr double kLongest = 150;

// How the places of a section are seen as they lie on the path: those of a band unrolled, around
// and along it.
class Layout {
  public:
    explicit Layout(const Section& section) : section_(section) {
        if (section.radius == 0) return;
        double high = 0;
        low_ = std::numeric_limits<double>::infinity();
        for (const Vec2& p : section.point) {
            unrolled_.push_back(unrolled(p));
            low_ = std::min(low_, unrolled_.back()[1]);
            high = std::max(high, unrolled_.back()[1]);
        }
        scale_ = std::max(section.radius, (high - low_) / kLongest);
        rise_ = high - low_;
    }

    // Where triangles of a band have the angles that they have on the path.
    Point drawn(const Vec2& p) const {
        if (section_.radius == 0) return Point(p[0], p[1]);
        const double far = p.norm();
        const double grown = portable::exp((far - low_) / scale_) / far;
        return Point(grown * p[0], grown * p[1]);
    }

    double distance2(const Vec2& p, const Vec2& q) const {
        if (section_.radius == 0) return (p - q).squaredNorm();
        return way(unrolled(p), unrolled(q)).squaredNorm();
    }

    double distance_to_segments(const Vec2& p) const {
        const bool is_band = section_.radius > 0;
        const Vec2 own = is_band ? unrolled(p) : p;
        double least = std::numeric_limits<double>::infinity();
        for (const auto* lines : {&section_.segment, &section_.line}) {
            for (const auto& [a, b] : *lines) {
                if (!is_band) {
                    const Vec2 &from = section_.point[a], &to = section_.point[b];
                    least = std::min(least, distance2_to_segment(p, from, to));
                    continue;
                }
                const Vec2 from = way(own, unrolled_[a]);
                const Vec2 to = from + way(unrolled_[a], unrolled_[b]);
                least = std::min(least, distance2_to_segment(Vec2::Zero(), from, to));
            }
        }
        return std::sqrt(least);
    }

    // Rows of points, each two beside each other this far apart.
    template <typename F>
    void for_each_of_rows(double apart, const F& f) const {
        const double rise = apart * std::sqrt(0.75);
        if (section_.radius > 0) {
            const int count =
                std::max(3, static_cast<int>(std::lround(2 * kPi * section_.radius / apart)));
            for (int j = 0; j * rise <= rise_; ++j) {
                for (int i = 0; i < count; ++i) {
                    const double turn = 2 * kPi * (i + 0.5 * (j & 1)) / count;
                    f(Vec2((low_ + j * rise) * Vec2(portable::cos(turn), portable::sin(turn))));
                }
            }
            return;
        }
        Vec2 low = section_.point.front(), high = low;
        for (const Vec2& p : section_.point) low = low.cwiseMin(p), high = high.cwiseMax(p);
        for (int j = 0; low[1] + j * rise <= high[1]; ++j) {
            for (int i = 0; low[0] + (i + 0.5 * (j & 1)) * apart <= high[0]; ++i) {
                f(Vec2(low[0] + (i + 0.5 * (j & 1)) * apart, low[1] + j * rise));
            }
        }
    }

  private:
    Vec2 unrolled(const Vec2& p) const {
        return {section_.radius * portable::atan2(p[1], p[0]), p.norm()};
    }
    // The shorter way around.
    Vec2 way(const Vec2& from, const Vec2& to) const {
        const double around = 2 * kPi * section_.radius;
        Vec2 way = to - from;
        way[0] -= around * std::round(way[0] / around);
        return way;
    }

    const Section& section_;
    std::vector<Vec2> unrolled_;  // of the section's points
    double low_ = 0, rise_ = 0, scale_ = 1;
};

// The wishes, then rows of points set off by half a spacing, all at a distance from the segments
// and from each other.
std::vector<Vec2> inner_points(const Section& section, const Layout& layout,
                               const Triangulation& cdt) {
    std::vector<Vec2> inner;
    Face hint;
    const auto offer = [&](const Vec2& p, double clearance) {
        hint = cdt.locate(layout.drawn(p), hint);
        if (cdt.is_infinite(hint) || hint->info() != 1) return;
        if (layout.distance_to_segments(p) < clearance) return;
        inner.push_back(p);
    };
    const double a = section.spacing;
    std::size_t wishes = 0;
    const auto is_free = [&](const Vec2& p, double reach) {
        return std::none_of(inner.begin(), inner.begin() + wishes, [&](const Vec2& wish) {
            return layout.distance2(p, wish) < reach * reach;
        });
    };
    for (const Vec2& p : section.wish) {  // a blade that comes back asks for the same ones again
        if (is_free(p, 0.2 * a)) offer(p, 0.3 * a);
        wishes = inner.size();
    }

    layout.for_each_of_rows(a, [&](const Vec2& p) {
        if (is_free(p, 0.5 * a)) offer(p, 0.45 * a);
    });
    return inner;
}

}  // namespace

std::optional<SectionTriangles> fill_section(const Section& section) {
    if (section.segment.empty()) return std::nullopt;
    const Layout layout(section);
    Triangulation cdt;
    std::vector<Vertex> vertex(section.point.size());
    Face hint;
    for (std::size_t n = 0; n < section.point.size(); ++n) {
        const std::size_t before = cdt.number_of_vertices();
        vertex[n] = cdt.insert(layout.drawn(section.point[n]), hint);
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
    result.added = inner_points(section, layout, cdt);
    hint = vertex.back()->face();  // constraints have put others in place of the one it was
    for (std::size_t n = 0; n < result.added.size(); ++n) {
        const Vertex v = cdt.insert(layout.drawn(result.added[n]), hint);
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
