// SPDX-License-Identifier: GPL-3.0-or-later
// What the passes of a picture draw: items that are ready, and shapes that need no mesh.
#pragma once

#include <vector>

#include "render/glm_bridge.h"
#include "render/mesh_cache.h"
#include "render/renderer.h"
#include "render/shaders.h"

namespace swage {

// An item, ready to draw.
struct Drawable {
    const DrawItem* item = nullptr;
    const GpuMesh* mesh = nullptr;
    glm::mat4 stage_from_mesh = glm::mat4(1);
    Box casting;         // what of it may cast shadows on the action [stage]; empty: nothing
    bool culls = false;  // closed, and seen from outside: its back faces are left out
};

// Halves the work where back faces are left out.
class Culling {
  public:
    Culling(const Gl& gl, bool cull) : gl_(gl), cull_(cull) {
        if (cull_) gl_.Enable(GL_CULL_FACE);
    }
    ~Culling() {
        if (cull_) gl_.Disable(GL_CULL_FACE);
    }
    Culling(const Culling&) = delete;
    Culling& operator=(const Culling&) = delete;

  private:
    const Gl& gl_;
    bool cull_;
};

// Whole items, whatever they are made of.
void draw_shapes(const Gl& gl, const Shader& shader, const std::vector<Drawable>& drawables);

// Shapes whose corners their shaders know.
class BareShapes {
  public:
    explicit BareShapes(const Gl& gl) : gl_(gl), nothing_(make_vertex_array(gl)) {}

    void cover_screen() const {
        gl_.BindVertexArray(nothing_.id());
        gl_.DrawArrays(GL_TRIANGLES, 0, 3);
    }
    void draw_ground() const {
        gl_.BindVertexArray(nothing_.id());
        gl_.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    }

  private:
    const Gl& gl_;
    GlHandle nothing_;
};

void set_unit(const Gl& gl, GLenum unit, GLuint texture);

}  // namespace swage
