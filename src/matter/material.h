// SPDX-License-Identifier: GPL-3.0-or-later
// What a user gives of a material: data-sheet numbers, SI units.
#pragma once

#include <limits>
#include <string>

namespace swage {

struct Material {
    std::string name = "custom";
    double young_modulus = 1e6;   // [Pa], > 0
    double poisson_ratio = 0.25;  // NOTE: lattices of springs alone are 1/4 whatever is asked
    double density = 1000;        // [kg/m3], > 0
    double yield_stress = std::numeric_limits<double>::infinity();  // [Pa], > 0; inf: never yields
    double hardening =
        0;  // [Pa] of stress per plastic strain, >= 0; 1 to 5 yield stresses for metals
    double damping_ratio = 0.05;  // of the highest lattice mode, 0 to 1; explicit steps only
    double friction = 0.3;        // Coulomb, against tools that do not say otherwise, >= 0
};

}  // namespace swage
