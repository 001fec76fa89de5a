// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that are put into each other, or into tools, by mistake.
#pragma once

#include <string>
#include <vector>

#include "machines/machine.h"
#include "pipeline/named_matter.h"

namespace swage {

// A sentence for every two bodies that share the room of a cell or more.
std::vector<std::string> start_overlaps(const std::vector<NamedMatter>& bodies);

// A sentence for every body beside the work-piece, which is the first, that starts in a tool of the
// machine, past the sides of one that is drawn endless, or behind it.
std::vector<std::string> tool_overlaps(const Machine& machine,
                                       const std::vector<NamedMatter>& bodies);

}  // namespace swage
