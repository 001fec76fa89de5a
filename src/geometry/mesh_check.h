// SPDX-License-Identifier: GPL-3.0-or-later
// What a mesh is: its size, and whether it bounds a volume.
#pragma once

#include <string>
#include <vector>

#include "geometry/box.h"
#include "geometry/trimesh.h"

namespace swage {

struct MeshReport {
    std::size_t vertices = 0, triangles = 0, polygons = 0;
    // Connected through shared vertices; closed surfaces that only touch, at edges or vertices,
    // count each.
    int components = 0;
    std::size_t materials = 0;
    bool has_uv = false;

    bool watertight = false;  // no edge has an odd number of triangles
    bool oriented = false;    // no edge is run along in one direction more than a manifold allows
    bool manifold = false;    // two triangles an edge at most, one fan of them a vertex

    std::size_t boundary_edges = 0;        // with one triangle
    std::size_t crowded_edges = 0;         // with more than two
    std::size_t disagreeing_edges = 0;     // whose triangles do not agree on the outside
    std::size_t crowded_vertices = 0;      // where more than one fan of triangles meets
    std::size_t degenerate_triangles = 0;  // of no area
    std::size_t duplicate_triangles = 0;   // with the same three vertices as an earlier one
    std::size_t unreferenced_vertices = 0;
    int inward_components = 0;  // closed, of negative volume: a cavity, or inside out

    double volume = 0;  // [m3], signed; means little unless the mesh bounds one
    double area = 0;    // [m2]
    Box box;            // [m], of the vertices in use

    std::vector<std::string> finding;  // a sentence for each thing that is not as it should be

    bool bounds_a_volume() const { return watertight && oriented && volume > 0; }
    // There is nothing to repair: of several bodies one may be inside out or inside another, also
    // where they share an edge or a vertex, and one body may be given twice.
    bool is_one_body() const {
        return bounds_a_volume() && components == 1 && manifold && duplicate_triangles == 0;
    }
};

MeshReport check_mesh(const TriMesh& mesh);

// "2930 vertices, 5856 triangles, 1 component, closed, volume 0.78 m3, box 1 x 2 x 3 m"
std::string summary_line(const MeshReport& report);

// Three significant digits or so, with a unit that fits: "12.5 cm", "3.4 cm3".
std::string length_text(double metres);
std::string volume_text(double cubic_metres);
std::string area_text(double square_metres);

// What each component encloses, if it is closed, about its own first vertex, so that it is exact
// wherever it lies [m3].
std::vector<double> component_volumes(const TriMesh& mesh, const Components& components);
// With the mesh's vertices elsewhere.
std::vector<double> component_volumes(const TriMesh& mesh, const std::vector<Vec3>& position,
                                      const Components& components);

}  // namespace swage
