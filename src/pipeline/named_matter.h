// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of matter as warnings name them, the work-piece first.
#pragma once

#include <string>
#include <vector>

#include "geometry/box.h"
#include "matter/aggregate.h"

namespace swage {

struct NamedMatter {
    std::string name;
    const Aggregate* matter;
    Box skin{};          // of its skin, as place_work_frame() has it
    double coarser = 1;  // as build_machine() has it
};

// Of all but the work-piece.
inline std::vector<Material> materials_beside(const std::vector<NamedMatter>& bodies) {
    std::vector<Material> beside;
    for (std::size_t b = 1; b < bodies.size(); ++b) beside.push_back(bodies[b].matter->material);
    return beside;
}

}  // namespace swage
