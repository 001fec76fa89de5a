// SPDX-License-Identifier: GPL-3.0-or-later
// What a body that is molded anew remembers of having flowed.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Gives each cell of `to`, as molded, the accumulated plastic strain of what it shares of the
// matter of `from` (mold/shared_matter.h), as its mean, or of the nearest where it shares none: the
// new body yields where the old one would have. Its rest shape is the new one. Of each material it
// is then scaled, so that hardening times mass is what it was: what gathers in a few cells that are
// filled in part is neither lost nor gained. A material that has no cell any more has none. Of a
// back stress each gets the mean of what the cells as wholes had, not of what their bending had.
void carry_hardening(const Aggregate& from, Aggregate& to);

}  // namespace swage
