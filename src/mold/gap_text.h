// SPDX-License-Identifier: GPL-3.0-or-later
// What a user is told of gaps that cells fill, and lengths as that tells them.
#pragma once

#include <string>
#include <vector>

#include "mold/filled_gaps.h"

namespace swage {

// Of what is only about so long.
std::string about(double length, int digits);

// The largest length of two digits that is no more than this, for what is advised must do: its
// digits after the second are left out. Of no more of them, for 0.1 is not quite a tenth.
std::string at_most(double length);

// `gaps`: one at least.
std::string gap_text(const std::vector<FilledGap>& gaps, double spacing);

}  // namespace swage
