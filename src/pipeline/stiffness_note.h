// SPDX-License-Identifier: GPL-3.0-or-later
// What explicit steps leave of the stiffness that a stage asks of contacts and grips: they hold it
// to what the steps can follow (sim/limited_stiffness.h).
#pragma once

#include <string>
#include <vector>

#include "pipeline/named_matter.h"
#include "scene/spec.h"

namespace swage {

// A sentence, where the stage asks for more than a tenth more than it has: what that is, and which
// step_safety gives all of it. Of the bodies as they are now; empty: nothing is to be told.
std::string stiffness_note(const StageSpec& stage, const std::vector<NamedMatter>& bodies);

// What tools that say nothing of their own have of the contact_stiffness of the stage, on the
// work-piece, which is the first.
double stiffness_share_at_tools(const StageSpec& stage, const std::vector<NamedMatter>& bodies);

}  // namespace swage
