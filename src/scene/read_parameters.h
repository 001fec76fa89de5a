// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/expressions.h"
#include "scene/table_reader.h"

namespace swage {

// The sections [parameter.NAME] of a machine file. From then on `expression` sees their names, and
// `counting` those of them that are certain before the work-piece is known.
void read_parameters(const Node& all, Reading& reading, MachineSpec& machine,
                     ExpressionReader& expression, ExpressionReader& counting);

}  // namespace swage
