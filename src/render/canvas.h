// SPDX-License-Identifier: GPL-3.0-or-later
// An OpenGL 3.3 core context without a window. The library that gives it is opened at run time:
// OSMesa, or EGL without a surface (Mesa dropped OSMesa after 25.0).
#pragma once

#include <memory>
#include <string>

#include "render/gl.h"
#include "render/settings.h"

namespace swage {

class GlProvider;

class Canvas {
  public:
    // The context belongs to the calling thread, which alone may draw and must destroy the canvas.
    // `threads` limits the software rasteriser of the whole process (first canvas decides); 0
    // leaves it as many as there are cores. Throws Error(output) naming the Debian packages.
    explicit Canvas(GlProviderKind kind, int threads = 0);
    ~Canvas();
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;

    const Gl& gl() const { return gl_; }
    GlProviderKind kind() const { return kind_; }  // the one in use, never automatic
    const std::string& renderer_string() const { return renderer_string_; }

    // The canvas of another thread's or an earlier call may be current: take it back.
    void make_current();

  private:
    bool try_kind(GlProviderKind kind, std::string& reasons);

    std::unique_ptr<GlProvider> provider_;
    GlProviderKind kind_ = GlProviderKind::automatic;
    Gl gl_;
    std::string renderer_string_;
};

}  // namespace swage
