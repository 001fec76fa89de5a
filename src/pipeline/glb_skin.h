// SPDX-License-Identifier: GPL-3.0-or-later
// A body's skin in glTF, as long as it has the same faces: a mesh that goes from shape to shape
// (morph targets), one for each frame in which it is another than before.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh_looks.h"
#include "pipeline/glb_file.h"

namespace swage {

// A surface by vertices that have one normal and one place in an image each.
class GlbSurface {
  public:
    GlbSurface(const TriMesh& mesh, MeshLooks& looks);
    GlbSurface(TriMesh mesh, const std::vector<int>& look);  // of each triangle

    bool has_normals() const { return has_normals_; }
    bool is_closed() const { return is_closed_; }
    std::size_t count() const { return vertex_.size(); }
    std::vector<Vec3> places(const std::vector<Vec3>& position) const;   // of its vertices
    std::vector<Vec3> normals(const std::vector<Vec3>& position) const;  // likewise; unit

    // Its primitives, one for each look, in the shape that `attributes` has.
    Json primitives(GlbFile& file, const Json& attributes, const MeshLooks& looks) const;

  private:
    struct Vertex {
        int position, smooth, uv;
        auto operator<=>(const Vertex&) const = default;
    };

    TriMesh mesh_;
    bool has_normals_, is_closed_;
    std::vector<Vertex> vertex_;
    std::vector<std::vector<std::uint32_t>> corner_;  // by look, three a triangle
};

// Of places as single floats, by axis.
struct GlbBounds {
    std::vector<float> low, high;
};
GlbBounds bounds_of(const std::vector<Vec3>& places);

// `from` as single floats, and what leads from there on to `to`.
std::vector<Vec3> in_floats(const std::vector<Vec3>& from);
std::vector<Vec3> way(const std::vector<Vec3>& from, const std::vector<Vec3>& to);
std::string glb_bytes(const std::vector<Vec3>& vectors);

}  // namespace swage
