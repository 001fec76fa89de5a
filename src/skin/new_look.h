// SPDX-License-Identifier: GPL-3.0-or-later
// What surfaces that come to be look like, from the look of the mesh.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/triangle_tree.h"
#include "geometry/trimesh.h"

namespace swage {

// Of faces that a blade or a break has laid open. A material that the mesh came with may have that
// name too: files then call the new one "cut.2".
inline constexpr const char* kCutMaterial = "cut";

// The number of that material in `mesh`, a part or a new surface of `like`. It is added where it is
// not there; so is the mesh's own where it has none. Metal is metal inside, and a plain colour goes
// through, paler; what a texture hides is pale; where a material says what is inside, it is that.
int cut_material(TriMesh& mesh, const TriMesh& like);

// What such a face looks like where nothing else lies inside.
SurfaceMaterial cut_look(const TriMesh& like);

// The number in `mesh` of a look of cut faces that show what lies inside; added where it is not
// there. It is known by its name, which begins as cut_name() has it.
int inside_material(TriMesh& mesh, const SurfaceMaterial& look);
std::string cut_name(const std::string& inside);

// Whether faces of this look are such as a blade or a break has laid open.
bool is_cut_look(const SurfaceMaterial& look);

// The look of a mesh for surfaces that are made anew from the same matter: each face has material,
// part, texture and colours of where the mesh is nearest at molding.
class NewLook {
  public:
    // The mesh as it was molded, not empty.
    explicit NewLook(const TriMesh& mesh);
    const TriMesh& mesh() const { return mesh_; }  // of which another is made that is alike

    // `mesh`: a boundary (skin/boundary.h); `place`: of its positions at molding. Faces of a cut,
    // of its material 1, get kCutMaterial and no texture.
    void paint(const std::vector<Vec3>& place, TriMesh& mesh) const;

  private:
    struct Face;
    Face look_of(const std::array<Vec3, 3>& place,
                 const std::array<TriangleTree::Nearest, 3>& corner) const;
    bool is_textured(int triangle) const;
    Vec2 texture_at(int triangle, const Vec3& weight) const;
    std::vector<int> patch_about(int triangle, const Vec3& middle, double reach) const;
    double texture_scale(int triangle) const;  // texture a length [1/m]

    TriMesh mesh_;
    TriangleTree tree_;
    // Across each triangle's edges, the first from its first corner to its second; -1: the surface
    // or its texture ends there.
    std::vector<Corners> adjoins_;
    std::vector<int> chart_;  // of each triangle: those that no seam parts share a number
};

}  // namespace swage
