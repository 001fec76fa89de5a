// SPDX-License-Identifier: GPL-3.0-or-later
// [[stage.limit]]: what a tool or grip of the stage's machine may bear; at it the machine comes no
// farther.
//
//     part    a tool or grip
//     force   the size of the force that it exerts on the matter; or
//     torque  that of the torque about the axis that it turns about
#pragma once

#include "scene/table_reader.h"

namespace swage {

struct MachineSpec;
enum class Solver;

// Adds those of a stage to its machine, whose parts and motions have been read.
void read_limits(TableReader& stage, Solver solver, MachineSpec& machine);

}  // namespace swage
