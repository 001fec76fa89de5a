// SPDX-License-Identifier: GPL-3.0-or-later
// What a body that is molded anew remembers of having flowed.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Gives each cell of `to`, as molded, the accumulated plastic strain of the cell of `from` that is
// there now: the new body yields where the old one would have. Its rest shape is the new one. Of a
// back stress each gets what the cell as a whole had, not what its bending had. Of several
// materials each gets what it had itself, where it is nearest.
void carry_hardening(const Aggregate& from, Aggregate& to);

}  // namespace swage
