// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machines/motion.h"

namespace swage {

// Whether a motion has turned at any of many times, whatever its expression is. Throws as
// evaluate().
bool ever_turns(const Motion& motion);

}  // namespace swage
