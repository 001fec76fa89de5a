// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/aggregate.h"

namespace swage {

// A cell that has just ceased to be sound, and what it held then.
struct TurnedCell {
    const CellRun* run;
    int n;          // of the run
    double energy;  // [J]

    CellId id() const { return run->first + n; }
};

}  // namespace swage
