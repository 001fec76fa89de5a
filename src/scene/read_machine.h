// SPDX-License-Identifier: GPL-3.0-or-later
// Machine files.
//
//     help = "what the machine does"
//     [parameter.NAME]            quantity, default, low, high, help
//     [[tool]]                    name, shape ("cylinder", "box", "sphere", "mesh"),
//                                 radius, length, size, rounding, file, axis, at,
//                                 touch, gap, friction, contact_stiffness (where nothing moves and
//                                 the stage does not say), color,
//                                 finish ("metal", "matt", "endless": matt, and fades out
//                                 into the backdrop)
//     [tool.motion]               move, turn, axis, pivot
//     [[grip]]                    name, from, to, and [grip.motion]
//     [[blade]]                   name, edge, thickness, and [blade.motion]
//     [[check]]                   holds, otherwise
//
// Where a number stands, an expression may stand (see base/expression.h; machine_spec.h says which
// variables it sees); axis and touch are plain numbers. A parameter's range is [low, high].
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "machines/machine_spec.h"
#include "scene/mistake.h"

namespace swage {

struct MachineReading {
    std::optional<MachineSpec> machine;  // nothing when there was a mistake (not a warning)
    std::vector<Mistake> mistakes;       // in the order of the file
};

// The machine's name is the stem of the file. Every expression is compiled, so what is left to go
// wrong later are values.
MachineReading read_machine(const std::filesystem::path& file);

}  // namespace swage
