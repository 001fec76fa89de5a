// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures on surfaces, read once each. A picture that cannot be read is one warning, and the
// surface shows its plain colour.
#pragma once

#include <map>
#include <string>

#include "geometry/trimesh.h"
#include "render/canvas.h"
#include "render/gl_handle.h"

namespace swage {

// Larger pictures are shrunk to this; on a still of common size nothing is lost.
inline constexpr int kLargestTextureSide = 4096;

class TextureCache {
  public:
    explicit TextureCache(const Gl& gl) : gl_(&gl) {}

    // The texture to bind; 0 for a material without one and for what cannot be read.
    GLuint texture(const SurfaceMaterial& material);

  private:
    GlHandle loaded(const SurfaceMaterial& material) const;

    const Gl* gl_;
    std::map<std::string, GlHandle> by_name_;  // of the file, or of what came inside the mesh
};

}  // namespace swage
