// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness of bars, measured as a laboratory would: from one loaded body each.
#pragma once

#include <optional>

#include "matter/aggregate.h"

namespace swage {

struct Stretch {
    double young_modulus, poisson_ratio;
};
// Pulls at both end faces of a bar of this section and unit modulus along a unit vector; strains
// are logarithmic, of the middle.
Stretch stretch(Aggregate bar, const Vec3& along, double section);

// Tip move over tip force of a bar held at its low end face, loaded across it. Starts from where a
// coarser body of that shape has come to rest, if there is one, and leaves its own there.
double bending_compliance(Aggregate bar, const Vec3& along, const Vec3& across,
                          std::optional<Aggregate>& rested);

// Torque over turn per length, its end faces turned against each other.
double torsion_stiffness(Aggregate bar, const Vec3& along);

}  // namespace swage
