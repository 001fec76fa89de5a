// SPDX-License-Identifier: GPL-3.0-or-later
// Whether what lies on tools stays there: as a rigid body, at the equilibria that frames ask for.
#pragma once

#include <string>

#include "machines/machine.h"
#include "matter/aggregate.h"
#include "scene/spec.h"

namespace swage {

// Of a work-piece that nothing holds, as it lies at the start: a sentence, where all that acts on
// it takes it away from every tool, or aside (pipeline/slide_doubt.h), or tips what is stiff,
// though it would lie there by its weight alone. Empty: it stays, or that is not sure.
// `lies_as_told`: false where what it is by then may lie otherwise; then only what is sure of any
// shape is told.
std::string rest_doubt(const StageSpec& stage, const Machine& machine, const Aggregate& matter,
                       bool lies_as_told);

}  // namespace swage
