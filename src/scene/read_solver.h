// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/spec.h"
#include "scene/table_reader.h"

namespace swage {

// The keys of a [[stage]] that say how its matter moves; the scene's materials have been read. What
// a solver cannot do with them is a mistake at `solver`, a key that it does not ask a warning.
// `machine`: null where there is none. With one for bodies in motion the solver left out is
// explicit, as it is for several bodies and for one that has a speed at the start; else
// quasi-static. `up`: against which gravity points that is a single number, as a stage has it.
// `remolds`: the stage's matter is molded anew.
void read_solver(TableReader& table, const SceneSpec& scene, const MachineSpec* machine,
                 WorldAxis up, bool remolds, SimSettings& sim);

}  // namespace swage
