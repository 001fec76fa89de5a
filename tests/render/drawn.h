// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures of simple bodies, and what is read from them.
#pragma once

#include "base/error.h"
#include "geometry/shape.h"
#include "render/renderer.h"
#include "tests/catch.h"

namespace swage {

inline RenderSettings small_picture() {
    RenderSettings settings;
    settings.width = 160;
    settings.height = 120;
    settings.camera[0].elevation = 0.6;
    return settings;
}

inline const Box kAction = {{-1, 0, -1}, {1, 1, 1}};

inline SurfaceMaterial colored(const Vec3& color) {
    SurfaceMaterial material;
    material.color = color;
    return material;
}

inline TriMesh box_mesh(double side) {
    return surface_of(BoxShape{Vec3::Constant(side), 0.02 * side});
}

inline double brightness(const Image& image, int x, int y) {
    const std::uint8_t* p = image.pixel(x, y);
    return (p[0] + p[1] + p[2]) / 3.0;
}

inline Image drawn(const RenderSettings& settings, const std::vector<DrawItem>& items,
                   double ground = 0, const Box& action = kAction) {
    Renderer renderer(settings, action, ground);
    return renderer.draw({items, 0});
}

inline bool can_draw(GlProviderKind kind = GlProviderKind::automatic) {
    RenderSettings settings = small_picture();
    settings.gl = kind;
    try {
        Renderer renderer(settings, kAction, 0);
        return true;
    } catch (const Error& error) {
        WARN("skipped: " << error.what());
        return false;
    }
}

}  // namespace swage
