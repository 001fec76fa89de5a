// SPDX-License-Identifier: GPL-3.0-or-later
// What cells bear, from their own energy: sigma = P F^T / J, P = dW/dF of the mean strain
// (laws/cell.h, laws/cell_foam.h; of two materials in a cell each its own, laws/laminate.h), at the
// centroid of their material, after the flow that they are at. Springs, those of mechanics
// "springs" and those that a cell turns into once it is severed or has reached its strength, bear
//
//     sigma = sum of T d n n^T / V           the virial of a cell's share of them
//
// T tension [N], softened as far as it is committed, d length [m], n direction, V volume [m3].
// Broken edges that are pressed are left out: the cells beside them show that pressure.
//
// Source of the virial: R. Clausius 1870; M. Born, K. Huang, "Dynamical Theory of Crystal
// Lattices", 1954.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "matter/stress_sample.h"

namespace swage {

// What a stress is to be: all of it, or what counts for flow, which is less by the back stress, and
// of springs as much as works (laws/yield.h); `yields_at` is then of that.
enum class Bears { all, of_flow };

// Of the cells that are asked for, in that order.
std::vector<StressSample> stress_samples(const Aggregate& matter, const std::vector<CellId>& cells,
                                         Bears what = Bears::all);

}  // namespace swage
