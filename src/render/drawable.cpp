// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/drawable.h"

namespace swage {

void draw_shapes(const Gl& gl, const Shader& shader, const std::vector<Drawable>& drawables) {
    shader.use();
    for (const Drawable& d : drawables) {
        shader.set_matrix("stage_from_mesh", glm::value_ptr(d.stage_from_mesh));
        const Culling culling(gl, d.culls);
        const auto count = static_cast<std::uint32_t>(d.mesh->split.index.size());
        d.mesh->draw(gl, {-1, false, 0, count});
    }
}

void set_unit(const Gl& gl, GLenum unit, GLuint texture) {
    gl.ActiveTexture(GL_TEXTURE0 + unit);
    gl.BindTexture(GL_TEXTURE_2D, texture);
}

}  // namespace swage
