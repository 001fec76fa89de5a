// SPDX-License-Identifier: GPL-3.0-or-later
// What a resolution is worth, from what `swage verify` measures.
#pragma once

#include "matter/material.h"

namespace swage {

// Relative errors of stiffness to expect of a part that is `cells` thick, in the worst of the directions
// tried: the round rod and the square bar that stand oblique to the lattice.
struct Accuracy {
    double bending, torsion;
    int cells_for_percent;  // thickness at which both are within 1 %
};

// Mechanics of cells only.
Accuracy accuracy_at(double cells);

}  // namespace swage
