// SPDX-License-Identifier: GPL-3.0-or-later
// A surface of triangles over welded positions. Attributes that may jump across an edge (texture
// coordinates, smoothing) belong to triangle corners and are kept apart from the positions, so
// that a texture seam never opens the surface.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "geometry/box.h"
#include "geometry/crease_angle.h"

namespace swage {

using Corners = std::array<int, 3>;
inline bool has_repeated_corner(const Corners& c) {
    return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}
// The cyclic order of the corners is ascending: of two triangles on the same corners, those that
// are alike in this face the same way.
inline bool corners_ascend(const Corners& c) {
    return (c[0] < c[1]) + (c[1] < c[2]) + (c[2] < c[0]) == 2;
}

// How a part of a surface looks. Colours are linear RGB, 0 to 1.
struct SurfaceMaterial {
    std::string name = {};
    Vec3 color = {0.8, 0.8, 0.8};
    double roughness = 0.55;
    double metallic = 0.0;
    double clear = 0.0;                  // share of the light that goes in and through, 0 to 1
    std::optional<Vec3> inside = {};     // colour of what lies under it; none: follows from its own
    bool takes_colors = true;            // a mesh's position_color multiplies `color`
    std::filesystem::path texture = {};  // absolute; empty for none. Multiplies `color`.
    // The image itself (a PNG or JPEG file's bytes) when it came inside the mesh file, as in GLB;
    // `texture` is empty then.
    std::shared_ptr<const std::string> embedded_texture = {};
};

struct TriMesh {
    // Compiled once: a copy is thousands of instructions, which many places make.
    TriMesh();
    ~TriMesh();
    TriMesh(const TriMesh&);
    TriMesh(TriMesh&&) noexcept;
    TriMesh& operator=(const TriMesh&);
    TriMesh& operator=(TriMesh&&) noexcept;

    std::vector<Vec3> position;     // [m], welded: one entry for each place
    std::vector<Corners> triangle;  // ids into position, counter-clockwise from outside

    // Each of the following is either empty or as long as said.
    std::vector<Eigen::Vector3f> position_color;  // one a position, linear RGB
    std::vector<Vec2> uv;                         // values that triangle_uv points at
    std::vector<Corners> triangle_uv;             // one a triangle; -1 where a corner has none
    int smooth_group_count = 0;                   // corners of one group share a shading normal
    std::vector<Corners> triangle_smooth;         // one a triangle: ids of smooth groups
    // Of the first groups: their normal at `position`, where it is not the one that the faces tell
    // now, as on triangles that were divided or lost a neighbour, or in a file that gives its own;
    // of any length, zero for none.
    std::vector<Vec3> smooth_normal;
    std::vector<int> triangle_polygon;   // one a triangle: triangles of one polygon (a quad, say)
                                         // are consecutive and share the number
    std::vector<int> triangle_material;  // one a triangle, into material
    std::vector<int> triangle_part;      // one a triangle, into part_name
    std::vector<SurfaceMaterial> material;
    std::vector<std::string> part_name;
};

// Calls act with each array that has a value a triangle; of several meshes, with theirs together.
template <class Act, class... Mesh>
void for_each_triangle_array(const Act& act, Mesh&... mesh) {
    act(mesh.triangle...);
    act(mesh.triangle_uv...);
    act(mesh.triangle_smooth...);
    act(mesh.triangle_polygon...);
    act(mesh.triangle_material...);
    act(mesh.triangle_part...);
}

// Enclosed volume [m3] by the divergence theorem, about the box centre. Exact for closed surfaces.
double signed_volume(const TriMesh& mesh);
// Twice a triangle's area, along its normal.
inline Vec3 area_vector(const std::vector<Vec3>& position, const Corners& t) {
    return (position[t[1]] - position[t[0]]).cross(position[t[2]] - position[t[0]]);
}
double surface_area(const TriMesh& mesh);

// Parts of the surface connected through shared positions; component[t] for each triangle.
struct Components {
    int count = 0;
    std::vector<int> triangle_component;
};
Components surface_components(const TriMesh& mesh);

// Fills smooth_group_count and triangle_smooth: corners at one position share a group when the
// faces meet at less than `crease_angle` [rad].
void smooth_by_crease_angle(TriMesh& mesh, double crease_angle = kCreaseAngle);

// The same where faces say with which they are smooth: those of one number above 0 (one a
// triangle), and triangles of one polygon.
void smooth_by_face_groups(TriMesh& mesh, const std::vector<int>& triangle_group);

// One unit normal a smooth group, weighted by corner angle, for the given positions (as many as
// mesh.position): the mean of its faces', or of what each of them makes of its smooth_normal as it
// moves. Groups must be present.
std::vector<Vec3> smooth_normals(const TriMesh& mesh, const std::vector<Vec3>& position);

// Gives each smooth group that has none its smooth_normal, so that it shades as it does now when
// its triangles are divided or some of them taken away. Without groups nothing is done.
void keep_smooth_normals(TriMesh& mesh);

}  // namespace swage
