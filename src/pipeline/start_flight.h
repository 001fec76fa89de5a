// SPDX-License-Identifier: GPL-3.0-or-later
// How long bodies fly freely when a stage begins (sim/free_flight.h), which takes next to no steps.
#pragma once

#include <vector>

#include "machines/machine.h"
#include "pipeline/named_matter.h"
#include "scene/spec.h"

namespace swage {

// Of the first stage, as the bodies are at its start, in steps of this length [s]; 0 where its
// tools move, or anything but gravity acts.
double start_flight(const StageSpec& stage, const Machine& machine,
                    const std::vector<NamedMatter>& bodies, double step);

}  // namespace swage
