// SPDX-License-Identifier: GPL-3.0-or-later
// Owners of OpenGL objects: each deletes its object when it goes. The context must be current.
#pragma once

#include <utility>

#include "render/gl.h"

namespace swage {

class GlHandle {
  public:
    using Destroy = void (*)(const Gl&, GLuint);

    GlHandle() = default;
    GlHandle(const Gl& gl, GLuint id, Destroy destroy) : gl_(&gl), id_(id), destroy_(destroy) {}
    GlHandle(GlHandle&& other) noexcept { swap(other); }
    GlHandle& operator=(GlHandle&& other) noexcept {
        GlHandle taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~GlHandle() {
        if (id_ != 0) destroy_(*gl_, id_);
    }
    GLuint id() const { return id_; }

  private:
    void swap(GlHandle& other) {
        std::swap(gl_, other.gl_);
        std::swap(id_, other.id_);
        std::swap(destroy_, other.destroy_);
    }

    const Gl* gl_ = nullptr;
    GLuint id_ = 0;
    Destroy destroy_ = nullptr;
};

inline GlHandle make_buffer(const Gl& gl) {
    GLuint id = 0;
    gl.GenBuffers(1, &id);
    return {gl, id, [](const Gl& g, GLuint i) { g.DeleteBuffers(1, &i); }};
}
inline GlHandle make_vertex_array(const Gl& gl) {
    GLuint id = 0;
    gl.GenVertexArrays(1, &id);
    return {gl, id, [](const Gl& g, GLuint i) { g.DeleteVertexArrays(1, &i); }};
}
inline GlHandle make_texture(const Gl& gl) {
    GLuint id = 0;
    gl.GenTextures(1, &id);
    return {gl, id, [](const Gl& g, GLuint i) { g.DeleteTextures(1, &i); }};
}
inline GlHandle make_renderbuffer(const Gl& gl) {
    GLuint id = 0;
    gl.GenRenderbuffers(1, &id);
    return {gl, id, [](const Gl& g, GLuint i) { g.DeleteRenderbuffers(1, &i); }};
}
inline GlHandle make_framebuffer(const Gl& gl) {
    GLuint id = 0;
    gl.GenFramebuffers(1, &id);
    return {gl, id, [](const Gl& g, GLuint i) { g.DeleteFramebuffers(1, &i); }};
}

}  // namespace swage
