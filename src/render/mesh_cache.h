// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes on the drawing side. What stays the same from picture to picture (triangles, texture
// coordinates, colours) is kept; moving positions are sent again. A mesh is recognised by its
// content, so addresses may be used again for something else.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "render/canvas.h"
#include "render/draw_mesh.h"
#include "render/gl_handle.h"

namespace swage {

struct GpuMesh {
    GlHandle vertex_array, moving, fixed, index;
    DrawMesh split;
    std::unique_ptr<TriMesh> smoothed;  // of a mesh that came without smooth groups
    Vec3 origin = Vec3::Zero();         // subtracted from positions, which keeps floats exact
    // Every side of a triangle has a counterpart that runs the other way: from outside, the inside
    // of the surface is never seen.
    bool closed = false;
    bool filled = false;
    int last_used = 0;

    void draw(const Gl& gl, const DrawMesh::Range& range) const;
};

class MeshCache {
  public:
    explicit MeshCache(const Gl& gl) : gl_(&gl) {}

    // The mesh ready to draw; valid until the next but one begin_picture(). `position` null: the
    // mesh's own. Throws Error(output) when there are not as many positions as the mesh has.
    const GpuMesh& prepared(const TriMesh& mesh, const std::vector<Vec3>* position);

    // Forgets what the last two pictures did not use.
    void begin_picture();

  private:
    // Content, and how many of the same content came before in this picture.
    using Key = std::pair<std::uint64_t, int>;

    std::unique_ptr<GpuMesh> made(const TriMesh& mesh) const;
    void send(GpuMesh& gpu, const TriMesh& mesh, const std::vector<Vec3>& position) const;

    const Gl* gl_;
    std::map<Key, std::unique_ptr<GpuMesh>> mesh_;
    std::map<std::uint64_t, int> seen_;
    int picture_ = 0;
};

}  // namespace swage
