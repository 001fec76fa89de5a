// SPDX-License-Identifier: GPL-3.0-or-later
// Tools that go into each other on their ways: what they then do to the work-piece is nonsense.
#pragma once

#include <string>
#include <vector>

#include "machines/machine.h"

namespace swage {

// A sentence for each pair that comes deeper into each other by more than `slack` [m] than it is at
// the start. `way`: of the motion of each tool, at the same even times, or empty.
std::vector<std::string> tool_clashes(const Machine& machine,
                                      const std::vector<std::vector<Pose>>& way, double slack);

}  // namespace swage
