// SPDX-License-Identifier: GPL-3.0-or-later
// What is odd about the energy books of a stage, in sentences for its user.
#pragma once

#include <string>
#include <vector>

#include "pipeline/stage_record.h"

namespace swage {

std::vector<std::string> judge_books(const StageEnd& end);

}  // namespace swage
