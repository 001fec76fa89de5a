// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sim/advance.h"

namespace swage {

// What a frame took the solver, for who follows a run; of no solver: "nothing to do".
std::string frame_account(const FrameReport& frame);

}  // namespace swage
