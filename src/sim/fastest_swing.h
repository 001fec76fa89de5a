// SPDX-License-Identifier: GPL-3.0-or-later
// How fast the lattice can swing at all, which bounds explicit steps.
#pragma once

#include "matter/aggregate.h"
#include "sim/lattice_forces.h"

namespace swage {

// Square of the highest angular frequency [1/s2] of the matter as it was molded, had nothing flowed
// (with what is severed or broken since), found from below, to a few per cent, by Lanczos's method
// in 25 evaluations of the forces. max(bound / mass) of LatticeForces::stiffness_bound() is 1.2 to
// 2 times as much where all cells are whole, and 5 to 20 times where the surface runs through them.
double fastest_swing_squared(const Aggregate& matter);

// The largest of the particles' stiffnesses over their masses [1/s2]: no swing's frequency squared
// is more, where they bound it.
double most_per_mass(const std::vector<double>& stiffness, const Aggregate& matter);

// What the matter's swings stay under, however it is strained within reason.
class SwingBound {
  public:
    // `parts`: a blade or a break may take cells apart, which then act as springs.
    SwingBound(const Aggregate& matter, bool parts);

    // As it has flowed by now, square of an angular frequency [1/s2]: what was found as molded,
    // with room, times what any particle has become stiffer by, or the plain bound where that is
    // less.
    double squared(const Aggregate& matter, const LatticeForces& lattice) const;

    // A blade has parted it, and some of its particles are lighter than they were.
    void masses_changed(const Aggregate& matter);

    template <typename Io>
    void visit(Io& io) {
        io(found_);
    }

  private:
    double found_;
    std::vector<float> molded_;  // stiffness bound of each particle [N/m]; empty: nothing flows
};

}  // namespace swage
