// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/aggregate.h"

namespace swage::test {

// Half the body's own material, above, and half its first inset's.
inline MixedCell halved_cell(CellId cell) {
    return {.cell = cell,
            .material = {0, 1},
            .fill = {0.5f, 0.5f},
            .centroid = {Eigen::Vector3f(0, 0.25f, 0), Eigen::Vector3f(0, -0.25f, 0)},
            .normal = Eigen::Vector3f::UnitY()};
}

}  // namespace swage::test
