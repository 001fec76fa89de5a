// SPDX-License-Identifier: GPL-3.0-or-later
// What a medium around the work-piece does to its true surface, in explicit steps.
#pragma once

#include <vector>

#include "laws/ambient_drag.h"
#include "laws/directional_drag.h"
#include "matter/aggregate.h"
#include "sim/settings.h"

namespace swage {

class SurfaceDrag {
  public:
    // A drag that would stop a point's lightest carrier within a few steps of this length [s] is
    // held to what a step can follow.
    SurfaceDrag(const Aggregate& matter, const SimSettings& settings, double step);

    bool acts() const { return ambient_.density * ambient_.coefficient > 0 || facing_.drag > 0; }

    // Adds the forces; returns the power that they take [W].
    double add_forces(const Aggregate& matter, Vec3Array& force);
    bool is_held() const { return held_; }  // whether any drag ever was

  private:
    AmbientDrag ambient_;
    DirectionalDrag facing_;
    std::vector<double> most_;  // force over speed, a point [N s/m]
    std::vector<Vec3> push_;
    std::vector<double> power_;
    bool held_ = false;
};

}  // namespace swage
