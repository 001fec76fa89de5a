// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace swage {

// Of a lattice of springs, whatever its material says: springs along the lines between points know
// one modulus (Cauchy's relation; laws/spring_damper.h).
inline constexpr double kPoissonOfSprings = 0.25;

}  // namespace swage
