// SPDX-License-Identifier: GPL-3.0-or-later
// What a resolution is worth, from what `swage verify` measures.
#pragma once

#include <limits>
#include <string>

#include "matter/material.h"

namespace swage {

// Relative errors of stiffness to expect of a part that is `cells` thick, in the worst of the
// directions tried: the round rod and the square bar that stand oblique to the lattice.
struct Accuracy {
    double bending, torsion;
    int cells_for_percent;  // thickness at which both are within 1 %
};

// Mechanics of cells only.
Accuracy accuracy_at(double cells);

// What a lattice of this spacing makes of a material's strength, `cells` over the thinnest side.
struct Resolved {
    double strength;      // [Pa] at which a smooth body breaks
    int cells_for_whole;  // over the thinnest side, at which that is the material's own; 0: it is
    bool whole() const { return cells_for_whole == 0; }
};
Resolved resolved_strength(const Material& material, double spacing, double cells);
inline constexpr double kMostAcross = 1e9;  // cells in all of a mold

// What may be told to resolve it.
struct Advisable {
    double across = kMostAcross;  // most cells over the thinnest side that the mold may have
    // [J/m2]; as much is strange of the material.
    double toughness = std::numeric_limits<double>::infinity();
};

// Empty where it is resolved, or nothing breaks. `section`: of the scene, that says how fine.
std::string strength_warning(const Material& material, double spacing, double cells,
                             const std::string& section = "[mold]", const Advisable& most = {});

}  // namespace swage
