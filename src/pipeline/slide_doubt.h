// SPDX-License-Identifier: GPL-3.0-or-later
// Whether grips, and the friction of tools, hold the work-piece where loads and gravity push it, at
// the equilibria that frames ask for.
#pragma once

#include <string>

#include "machines/machine.h"
#include "matter/aggregate.h"
#include "scene/spec.h"

namespace swage {

// Of a work-piece in grips that leave ways free, or on tools, as it lies at the start: a sentence
// that names the way on which it goes off, as a rigid body. Empty: it stays, or that is not sure.
// `lies_as_told`: as rest_doubt() has it.
std::string slide_doubt(const StageSpec& stage, const Machine& machine, const Aggregate& matter,
                        bool lies_as_told);

}  // namespace swage
