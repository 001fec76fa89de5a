// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: hole filling, P. Liepa, "Filling holes in meshes", 2003; wrapping, C. Portaneri et al.,
// "Alpha wrapping with an offset", 2022; both as in CGAL 5.5.
#include "geometry/mesh_repair_cgal.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <exception>
#include <map>
#include <memory>
#include <set>

#include "geometry/disjoint_sets.h"
#include "geometry/polygon.h"

namespace swage {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;
using Face = Surface::Face_index;

// Beyond it, the search for the best filling takes too long; ears do.
constexpr std::size_t kLargestOutline = 1000;

Point to_cgal(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

// False when the triangles do not form a manifold.
bool to_surface(const TriMesh& mesh, Surface& surface) {
    surface.reserve(static_cast<unsigned>(mesh.position.size()),
                    static_cast<unsigned>(3 * mesh.triangle.size()),
                    static_cast<unsigned>(mesh.triangle.size()));
    for (const Vec3& p : mesh.position) surface.add_vertex(to_cgal(p));
    for (const Corners& t : mesh.triangle)
        if (surface.add_face(Surface::Vertex_index(static_cast<unsigned>(t[0])),
                             Surface::Vertex_index(static_cast<unsigned>(t[1])),
                             Surface::Vertex_index(static_cast<unsigned>(t[2]))) ==
            Surface::null_face())
            return false;
    return true;
}

TriMesh from_surface(const Surface& surface) {
    TriMesh mesh;
    std::map<Surface::Vertex_index, int> place;
    for (const auto v : surface.vertices()) {
        place[v] = static_cast<int>(mesh.position.size());
        const Point& p = surface.point(v);
        mesh.position.emplace_back(p.x(), p.y(), p.z());
    }
    for (const Face f : surface.faces()) {
        Corners corners{};
        int k = 0;
        for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
            corners[k++] = place.at(v);
        mesh.triangle.push_back(corners);
    }
    return mesh;
}

// Follows each face through cuts and copies back to the face it came from.
struct OriginVisitor : CGAL::Polygon_mesh_processing::Corefinement::Default_visitor<Surface> {
    using Origin = std::map<const Surface*, std::vector<int>>;  // of each face, -1: not known
    std::shared_ptr<Origin> origin = std::make_shared<Origin>();
    int cut = -1;  // origin of the face being cut

    void put(const Surface& surface, Face face, int from) {
        std::vector<int>& known = (*origin)[&surface];
        if (known.size() <= face.idx()) known.resize(face.idx() + 1, -1);
        known[face.idx()] = from;
    }
    int get(const Surface& surface, Face face) const {
        const std::vector<int>& known = (*origin)[&surface];
        return face.idx() < known.size() ? known[face.idx()] : -1;
    }
    void before_subface_creations(Face face, const Surface& surface) { cut = get(surface, face); }
    void after_subface_created(Face face, const Surface& surface) { put(surface, face, cut); }
    void after_face_copy(Face from, const Surface& source, Face to, const Surface& target) {
        put(target, to, get(source, from));
    }
};

}  // namespace

std::vector<Corners> fill_outline(const std::vector<Vec3>& outline) {
    std::vector<Corners> triangle;
    if (outline.size() <= kLargestOutline) {
        std::vector<Point> points;
        for (const Vec3& p : outline) points.push_back(to_cgal(p));
        std::vector<CGAL::Triple<int, int, int>> filling;
        try {
            CGAL::Polygon_mesh_processing::triangulate_hole_polyline(points,
                                                                     std::back_inserter(filling));
        } catch (const std::exception&) {
            filling.clear();
        }
        for (const auto& t : filling) {
            Corners corners = {t.first, t.second, t.third};
            std::sort(corners.begin(), corners.end());  // the sense of the outline
            triangle.push_back(corners);
        }
    }
    if (triangle.size() + 2 == outline.size()) return triangle;
    triangle.clear();
    if (!cut_polygon(outline, triangle)) triangle.clear();
    return triangle;
}

TriMesh wrap_triangles(const TriMesh& mesh, double alpha, double offset) {
    std::vector<Point> points;
    for (const Vec3& p : mesh.position) points.push_back(to_cgal(p));
    Surface wrap;
    CGAL::alpha_wrap_3(points, mesh.triangle, alpha, offset, wrap);
    return from_surface(wrap);
}

bool cut_along_each_other(const TriMesh& a, const TriMesh& b, CutPatches& cut_a,
                          CutPatches& cut_b) {
    namespace pmp = CGAL::Polygon_mesh_processing;
    Surface first, second;
    if (!to_surface(a, first) || !to_surface(b, second)) return false;
    OriginVisitor visitor;
    for (Surface* surface : {&first, &second})
        for (const Face f : surface->faces()) visitor.put(*surface, f, static_cast<int>(f.idx()));
    const auto on_cut_a = first.add_property_map<Surface::Edge_index, bool>("e:cut", false).first;
    const auto on_cut_b = second.add_property_map<Surface::Edge_index, bool>("e:cut", false).first;
    try {
        pmp::corefine(first, second,
                      pmp::parameters::visitor(visitor)
                          .edge_is_constrained_map(on_cut_a)
                          .throw_on_self_intersection(true),
                      pmp::parameters::edge_is_constrained_map(on_cut_b));
    } catch (const std::exception&) {
        return false;
    }
    const auto finish = [&](const Surface& surface, const auto& on_cut, CutPatches& cut) {
        cut.mesh = from_surface(surface);
        cut.origin.clear();
        cut.patch.clear();
        std::map<Face, int> number;
        for (const Face f : surface.faces()) {
            number[f] = static_cast<int>(cut.origin.size());
            cut.origin.push_back(visitor.get(surface, f));
            if (cut.origin.back() < 0) return false;
        }
        DisjointSets sets(cut.origin.size());
        for (const auto e : surface.edges())
            if (!on_cut[e])
                sets.unite(number.at(surface.face(surface.halfedge(e, 0))),
                           number.at(surface.face(surface.halfedge(e, 1))));
        sets.number_sets(cut.patch);
        return true;
    };
    return finish(first, on_cut_a, cut_a) && finish(second, on_cut_b, cut_b);
}

std::optional<std::vector<std::pair<int, int>>> parts_that_meet(const TriMesh& mesh,
                                                                const std::vector<int>& part,
                                                                std::size_t most) {
    using Bounds = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;
    std::vector<Kernel::Triangle_3> triangle;
    std::vector<Bounds> bounds;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const Corners& c = mesh.triangle[t];
        triangle.emplace_back(to_cgal(mesh.position[c[0]]), to_cgal(mesh.position[c[1]]),
                              to_cgal(mesh.position[c[2]]));
        // What has no area lies on the edges of its neighbours.
        if (triangle[t].is_degenerate()) continue;
        bounds.emplace_back(triangle[t].bbox(), static_cast<int>(t));
    }
    struct TooMany {};
    std::set<std::pair<int, int>> meeting;
    std::size_t looked = 0;
    try {
        CGAL::box_self_intersection_d(
            bounds.begin(), bounds.end(), [&](const Bounds& a, const Bounds& b) {
                if (++looked > most) throw TooMany();
                const std::pair<int, int> parts = std::minmax(part[a.info()], part[b.info()]);
                if (parts.first == parts.second || meeting.contains(parts)) return;
                if (CGAL::do_intersect(triangle[a.info()], triangle[b.info()]))
                    meeting.insert(parts);
            });
    } catch (const TooMany&) {
        return std::nullopt;
    }
    return std::vector<std::pair<int, int>>(meeting.begin(), meeting.end());
}

}  // namespace swage
