// SPDX-License-Identifier: GPL-3.0-or-later
// What a body that is molded anew keeps of how it moved.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Gives each particle of `to`, as molded, the velocity that `from` has there, and all of them the
// same momentum and spin in all: matter that moves as a whole goes on as it went, and motion within
// it gains no energy.
void carry_motion(const Aggregate& from, Aggregate& to);

}  // namespace swage
