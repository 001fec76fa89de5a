// SPDX-License-Identifier: GPL-3.0-or-later
// What gives way under a body's surface: Young's modulus of the material just beneath.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Of each point [Pa]; empty where the body is of one material.
std::vector<double> surface_moduli(const Aggregate& matter, const SurfacePoints& points);

// The mean over the body's surface [Pa].
double surface_modulus(const Aggregate& matter);

}  // namespace swage
