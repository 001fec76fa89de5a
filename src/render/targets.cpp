// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/targets.h"

#include <algorithm>

#include "base/error.h"

namespace swage {

namespace {

GlHandle texture_of(const Gl& gl, int width, int height, GLenum format, GLenum layout) {
    GlHandle texture = make_texture(gl);
    gl.BindTexture(GL_TEXTURE_2D, texture.id());
    gl.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0, layout, GL_FLOAT,
                  nullptr);
    const GLint filter = format == GL_RGBA8 || format == GL_RGBA16F ? GL_LINEAR : GL_NEAREST;
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

GlHandle buffer_of(const Gl& gl, int width, int height, GLenum format, int samples) {
    GlHandle buffer = make_renderbuffer(gl);
    gl.BindRenderbuffer(GL_RENDERBUFFER, buffer.id());
    if (samples > 0) {
        gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
    } else {
        gl.RenderbufferStorage(GL_RENDERBUFFER, format, width, height);
    }
    return buffer;
}

}  // namespace

void Target::bind(const Gl& gl) const {
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    gl.Viewport(0, 0, width, height);
}

Target make_target(const Gl& gl, int width, int height, const TargetFormat& format) {
    Target target;
    target.width = width;
    target.height = height;
    target.framebuffer = make_framebuffer(gl);
    gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.id());
    if (format.color == 0) {
        gl.DrawBuffer(GL_NONE);
        gl.ReadBuffer(GL_NONE);
    } else if (format.samples > 0) {
        target.color = buffer_of(gl, width, height, format.color, format.samples);
        gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                   target.color.id());
    } else {
        target.color = texture_of(gl, width, height, format.color, GL_RGBA);
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                                target.color.id(), 0);
    }
    if (format.depth_texture) {
        target.depth = texture_of(gl, width, height, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT);
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D,
                                target.depth.id(), 0);
    } else if (format.depth_buffer) {
        target.depth = buffer_of(gl, width, height, GL_DEPTH_COMPONENT24, format.samples);
        gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                   target.depth.id());
    }
    const GLenum status = gl.CheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE || gl.GetError() == GL_OUT_OF_MEMORY) {
        fail(ExitCode::output, "OpenGL cannot draw pictures of {} x {} pixels here (status {:#x})",
             width, height, status);
    }
    return target;
}

namespace {

// Asks without making it.
bool can_make(const Gl& gl, int width, int height, GLenum format) {
    gl.TexImage2D(GL_PROXY_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0, GL_RGBA,
                  GL_FLOAT, nullptr);
    GLint given = 0;
    gl.GetTexLevelParameteriv(GL_PROXY_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &given);
    return given == width;
}

}  // namespace

void try_targets(const Gl& gl, const RenderSettings& settings) {
    const int width = settings.width, height = settings.height;
    // The largest of a pixel: of them all less would do.
    const GLenum format = !settings.passes.empty() ? kLayerFormat.color : kStillFormat.color;
    if (can_make(gl, width, height, format)) return;
    const int longer = std::max(width, height);
    const auto scaled = [&](int side, int to) {
        return std::max(1, static_cast<int>(static_cast<long>(side) * to / longer));
    };
    int most = 0, beyond = longer;
    while (beyond - most > 1) {
        const int between = most + (beyond - most) / 2;
        const bool can = can_make(gl, scaled(width, between), scaled(height, between), format);
        (can ? most : beyond) = between;
    }
    fail(ExitCode::output, "OpenGL cannot draw pictures of {} x {} pixels{} here, at most {} x {}",
         width, height, settings.passes.empty() ? "" : " with their passes", scaled(width, most),
         scaled(height, most));
}

}  // namespace swage
