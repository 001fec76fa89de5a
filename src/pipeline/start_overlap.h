// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that are put into each other, or into tools, by mistake.
#pragma once

#include <string>
#include <vector>

#include "machines/machine.h"
#include "pipeline/named_matter.h"

namespace swage {

// Of bodies as they were molded: a sentence for all pairs that share the room of a cell or more,
// and one for those that lie in each other by more than a twentieth of a cell. Each names the pair
// that is worst.
std::vector<std::string> start_overlaps(const std::vector<NamedMatter>& bodies);

// A sentence for every tool of the machine that bodies beside the work-piece, which is the first,
// start in, and for every body past the sides of one that is drawn endless, or behind it. As they
// were molded, and to move, the work-piece too, and from a twentieth of a cell on: nothing presses
// there by right.
std::vector<std::string> tool_overlaps(const Machine& machine,
                                       const std::vector<NamedMatter>& bodies,
                                       bool to_move_as_molded = false);

// Which of the bodies these sentences tell of as deep. As they were molded, and to move, also those
// that start_overlaps() tells of, given how deep contact finds each in others [m].
std::vector<char> start_deep(const Machine& machine, const std::vector<NamedMatter>& bodies,
                             const std::vector<double>& overlaps, bool to_move_as_molded);

}  // namespace swage
