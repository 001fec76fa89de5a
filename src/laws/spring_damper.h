// SPDX-License-Identifier: GPL-3.0-or-later
// The connection of Jansson & Vergeest (S2.3, S2.4), equal to the LS connector of Joukhadar &
// Laugier (S0.1): a spring and a dashpot along the line between two particles.
//
//     T = k (d - l) + b v          tension [N], positive pulls the ends together
//     W = k (d - l)^2 / 2          elastic energy [J]
//
// d distance of the ends [m], l rest_length [m], v rate of d [m/s], k stiffness [N/m], b damping
// [N s/m]. The force on the first end is T times the unit vector from the first to the second.
//
// In an isotropic lattice of 18 neighbours with spacing a, every connection has
//
//     k = 0.4 E a w
//
// with w the share of its surrounding cells that is solid: uniform strain then gives each cell's
// corners exactly the consistent forces of Hooke's law with Young's modulus E and Poisson's ratio
// 1/4 (Cauchy's relation), for any union of cells. The paper has no such mapping (S2.19).
#pragma once

namespace swage {

struct SpringDamper {
    double stiffness;    // k [N/m], > 0
    double damping;      // b [N s/m], >= 0
    double rest_length;  // l [m], > 0
};

template <typename Number>
Number spring_tension(const SpringDamper& c, const Number& distance, const Number& rate) {
    return c.stiffness * (distance - c.rest_length) + c.damping * rate;
}

template <typename Number>
Number spring_energy(const SpringDamper& c, const Number& distance) {
    return 0.5 * c.stiffness * (distance - c.rest_length) * (distance - c.rest_length);
}

// T = k (d - l) over k d, as sweeps over many want it, with no division: d over the
// reference_length has the inverse 1 / y, and l the ratio 1 + p to it.
template <typename Number>
Number spring_slack(const Number& y) {
    return 1.0 - y;
}
template <typename Number>
Number spring_slack(const Number& y, const Number& p) {
    return 1.0 - (y + p * y);
}
// Where the strain d / l - 1 is s.
inline double slack_at(double s) { return s / (1 + s); }

// k of a connection whose surrounding cells are wholly solid [N/m].
inline double lattice_stiffness(double young_modulus, double spacing) {
    return 0.4 * young_modulus * spacing;
}

}  // namespace swage
