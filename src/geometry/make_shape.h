// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes that the project makes itself: `swage make SHAPE`. All are closed, manifold and
// outward, with texture coordinates, smoothing and a material.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geometry/atlas.h"
#include "geometry/trimesh.h"

namespace swage {

enum class ParameterKind { length, angle, number, count };  // m, rad, plain, whole

struct ShapeParameter {
    std::string name;
    ParameterKind kind;
    double value;  // default
    double low, high;
    std::string help;
};

struct ShapeInfo {
    std::string name;
    std::string help;
    std::vector<ShapeParameter> parameters;
};

struct MadeShape {
    TriMesh mesh;
    // Belongs to mesh.material[0], whose path is left to whoever writes the picture to disk.
    std::optional<Texture> texture;
};

const std::vector<ShapeInfo>& shape_catalogue();

// Parameters that are left out take their defaults. Throws Error(command_line) for an unknown
// shape or parameter, naming those there are, and for a value out of its range or of no sense
// together with the others. The same parameters give the same bytes.
MadeShape make_shape(const std::string& name, const std::map<std::string, double>& parameters);

}  // namespace swage
