// SPDX-License-Identifier: GPL-3.0-or-later
// What is odd about a move of the drive, in sentences for its user.
#pragma once

#include <string>
#include <vector>

#include "sim/move_outcome.h"

namespace swage {

std::vector<std::string> move_warnings(const MoveOutcome& outcome);

}  // namespace swage
