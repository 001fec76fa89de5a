// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that are put into each other by mistake.
#pragma once

#include <string>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

struct NamedMatter {
    std::string name;
    const Aggregate* matter;
};

// A sentence for every two bodies that share the room of a cell or more.
std::vector<std::string> start_overlaps(const std::vector<NamedMatter>& bodies);

}  // namespace swage
