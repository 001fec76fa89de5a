// SPDX-License-Identifier: GPL-3.0-or-later
// What a user gives of a material: data-sheet numbers, SI units.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "laws/flow_curve.h"

namespace swage {

enum class Mechanics {
    cells,    // strain of whole cells: any Poisson's ratio, right in bending on coarse lattices
    springs,  // the papers' connections alone: Poisson's ratio 1/4
};

enum class Elasticity {
    hencky,       // linear in the logarithmic strain; what can yield
    neo_hookean,  // rubber: resists being turned inside out
    storakers,    // foam: that too, and the same Poisson's ratio however far it is pressed
};

struct Material {
    bool breaks() const { return strength < std::numeric_limits<double>::infinity(); }
    bool yields() const { return yield_stress < std::numeric_limits<double>::infinity(); }
    bool shifts() const { return yields() && back_stress > 0; }

    std::string name = "custom";
    Mechanics mechanics = Mechanics::cells;
    Elasticity elasticity = Elasticity::hencky;
    double young_modulus = 1e6;   // [Pa], > 0
    double poisson_ratio = 0.25;  // 0 to 0.49; springs are 1/4 whatever is asked
    double density = 1000;        // [kg/m3], > 0
    double yield_stress = std::numeric_limits<double>::infinity();  // [Pa], > 0; inf: never yields
    double hardening =
        0;  // [Pa] of stress per plastic strain, >= 0; 1 to 5 yield stresses for metals
    // Instead of hardening: the stress over the plastic strain, from yield_stress at 0 on, in
    // straight lines, flat behind the last; empty: none.
    std::vector<FlowPoint> flow_curve = {};
    // Of the stress at which it flows, the part that shifts with the flow instead of growing, so
    // that flow back sets in early: what it comes to [Pa], and the plastic strain over which it
    // does all but 1/e of that, which are C/gamma and 1/gamma of Armstrong and Frederick's law. 0:
    // none.
    double back_stress = 0, back_strain = 0;
    // Both or neither. Stress at which a bar that is pulled breaks [Pa], > 0 and below a tenth of
    // young_modulus; inf: never. Energy of a new crack, both its faces together [J/m2], > 0.
    double strength = std::numeric_limits<double>::infinity();
    double toughness = std::numeric_limits<double>::infinity();
    // The following but for friction act in motion, not in implicit steps.
    double damping_ratio = 0.05;  // of every swing, 0 to 0.3: half its loss factor
    double friction = 0.3;        // Coulomb, against tools that do not say otherwise, >= 0
    // Where nothing slides yet, >= friction; less counts as friction. On tools whose friction is
    // another, in its proportion.
    double static_friction = 0;
    // Speed after over speed before, where its surface meets another, 0 to 1.
    double restitution = 0.5;
    // Tension that it holds once it touches other matter or a tool [Pa], >= 0.
    double stickiness = 0;

    void flow_along(std::vector<FlowPoint> curve) {
        yield_stress = curve.front().stress, hardening = 0;
        flow_curve = std::move(curve);
    }
    double holding_friction() const {
        return static_friction > friction ? static_friction : friction;
    }
};

}  // namespace swage
