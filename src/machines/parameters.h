// SPDX-License-Identifier: GPL-3.0-or-later
// A machine's parameters: given ones checked, the rest by their defaults.
#pragma once

#include <map>
#include <string>

#include "machines/machine_spec.h"
#include "machines/motion.h"

namespace swage {

// `known` are the variables of the work-piece. Returns every parameter, SI. Throws Error(scene)
// naming machine, parameter, value and allowed range.
Variables resolve_parameters(const MachineSpec& spec, const Variables& given,
                             const Variables& known);

}  // namespace swage
