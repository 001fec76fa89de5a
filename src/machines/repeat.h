// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a machine that stand there several times.
#pragma once

#include <string_view>

#include "machines/machine_spec.h"
#include "machines/motion.h"

namespace swage {

constexpr int kMostRepeats = 100;

// Each part that is repeated as so many parts, NAME_1, NAME_2, and so on; what are single parts
// already stays. `known`: the parameters that `repeat` may use. Throws ParameterError, of the first
// that it uses, where it is no whole number from 0 to kMostRepeats.
MachineSpec with_single_parts(MachineSpec machine, const Variables& known);

// Whether that is a name of one of the single parts that a repeated part becomes.
bool is_numbered(std::string_view part, std::string_view repeated);

// Whether a single part is called that: NAME_2 is by its own name and, as one of several, by NAME.
bool is_called(std::string_view part, std::string_view name);

}  // namespace swage
