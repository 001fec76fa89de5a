// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth tool surfaces as signed distances: negative inside, gradient of length one outward.
// Contact needs a normal everywhere, so boxes have rounded edges (see `rounding`).
#pragma once

#include <memory>
#include <variant>

#include "base/math.h"
#include "geometry/box.h"
#include "geometry/trimesh.h"

namespace swage {

class DistanceField;  // a mesh's signed distance, sampled on a grid (geometry/distance_field.h)

// All shapes lie about the origin of their own frame. Lengths in m.
struct CylinderShape {  // axis along z, flat ends
    double radius;
    double length;
    double hole = 0;      // radius of a hole through it, along its axis; under `radius`
    double rounding = 0;  // radius of its rims, those of the hole too; the outer size stays
};
struct BoxShape {
    Vec3 size;
    double rounding;  // radius of edges and corners; the outer size stays `size`
};
struct SphereShape {
    double radius;
};
struct MeshShape {
    std::shared_ptr<const TriMesh> mesh;
    std::shared_ptr<const DistanceField> field;
};
using Shape = std::variant<CylinderShape, BoxShape, SphereShape, MeshShape>;

struct Distance {
    double value;  // [m]
    Vec3 normal;   // unit, outward
};
Distance distance_to(const Shape& shape, const Vec3& point);

// Bounds in the shape's own frame.
Box bounds_of(const Shape& shape);

bool is_convex(const Shape& shape);

// About the shortest way through it [m].
double thinness_of(const Shape& shape);

// The surface for drawing and export, in the shape's own frame.
TriMesh surface_of(const Shape& shape);

}  // namespace swage
