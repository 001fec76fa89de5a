// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/aggregate.h"

namespace swage {

// By which the cells of its n-th material press. Springs have one law, whatever the material says.
inline Elasticity elasticity_of(const Aggregate& matter, std::size_t n) {
    return matter.material.mechanics == Mechanics::cells ? matter.material_at(n).elasticity
                                                         : Elasticity::hencky;
}

}  // namespace swage
