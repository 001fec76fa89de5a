// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures on surfaces, read once each. A picture that cannot be read is one warning, and the
// surface shows its plain colour.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "render/canvas.h"
#include "render/gl_handle.h"

namespace swage {

class TextureCache {
  public:
    explicit TextureCache(const Gl& gl) : gl_(&gl) {}

    // The texture to bind; 0 for an empty path and for what cannot be read.
    GLuint texture(const std::filesystem::path& file);

  private:
    GlHandle loaded(const std::filesystem::path& file) const;

    const Gl* gl_;
    std::map<std::string, GlHandle> by_name_;
};

}  // namespace swage
