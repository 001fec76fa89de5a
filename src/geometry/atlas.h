// SPDX-License-Identifier: GPL-3.0-or-later
// Texture coordinates for any closed surface, and textures painted from a function of the place.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/math.h"
#include "geometry/trimesh.h"

namespace swage {

struct Texture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  // sRGB, rows from the top
};

struct AtlasSettings {
    int size = 1024;    // texels a side, at least 64; the coordinates suit larger textures too
    double margin = 4;  // texels around each chart
    // Texels a length is given, relative to other places, > 0; empty: the same everywhere. Charts
    // end where it changes, so it should take a few values only.
    std::function<double(const Vec3&)> density;
};

// Cuts the surface into charts that face one of the six axis directions, without folds, projects
// each along its axis and packs them into the unit square. Fills uv and triangle_uv.
void unwrap(TriMesh& mesh, const AtlasSettings& settings = {});

// Colour in sRGB, 0 to 1, at a place with its outward unit normal. Called from many threads.
using Paint = std::function<Vec3(const Vec3& place, const Vec3& normal)>;

// Fills every texel: those of a chart by the place of the surface that they show, those between
// the charts by the nearest of these. Needs texture coordinates and smooth groups.
Texture paint_texture(const TriMesh& mesh, int size, const Paint& paint);

}  // namespace swage
