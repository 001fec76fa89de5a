// SPDX-License-Identifier: GPL-3.0-or-later
// What a stage of equilibria leaves out of the motion that it begins with: they have no speed.
#pragma once

#include <string>
#include <vector>

#include "pipeline/work_piece.h"

namespace swage {

struct MotionLeft {
    double energy = 0;     // kinetic [J]
    double speed = 0;      // of the fastest particle [m/s]
    double is_little = 0;  // energy of what goes less than a cell in a second [J]
};
MotionLeft motion_of(const std::vector<WorkPiece>& bodies);

// A sentence, where that is more than next to nothing, and than a hundredth of what is held as
// strain [J]; else empty.
std::string motion_note(const MotionLeft& left, double elastic);

}  // namespace swage
