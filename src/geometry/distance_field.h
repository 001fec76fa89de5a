// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh's signed distance, sampled on a grid around it and interpolated so that its gradient is
// continuous: a surface that contact can press on.
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/box.h"
#include "geometry/shape.h"
#include "geometry/trimesh.h"

namespace swage {

class DistanceField {
  public:
    // `spacing` of the samples [m], > 0; 0 takes 1/80 of the longest side of the mesh's box, or,
    // where a closed mesh is thin, a third of its mean thickness, as far as 2^22 samples go.
    // Sharp edges come out rounded by about one spacing. Throws Error(mesh) without triangles and
    // Error(resources) above 2^27 samples.
    explicit DistanceField(const TriMesh& mesh, double spacing = 0);

    // Negative inside. Near the surface the error falls with spacing^3. Outside the sampled box
    // the distance goes on, positive and continuous, and errs by less than one part in a hundred.
    Distance at(const Vec3& point) const;

    double spacing() const { return spacing_; }
    Box sampled() const { return sampled_; }         // where samples are interpolated
    bool has_inside() const { return has_inside_; }  // whether any sample lies there

  private:
    Distance interpolate(const Vec3& point) const;

    double spacing_ = 0;
    Vec3 origin_ = Vec3::Zero();  // of sample (0, 0, 0)
    Vec3i count_ = Vec3i::Zero();
    Box sampled_;
    std::vector<float> sample_;  // x fastest
    bool has_inside_ = false;
};

}  // namespace swage
