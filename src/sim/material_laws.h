// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "laws/cell_forces.h"
#include "matter/aggregate.h"
#include "sim/flow.h"

namespace swage {

// One of a body's materials as the laws take it.
struct MaterialLaw {
    CellModuli moduli;
    CellKind kind;
};
// By material; without flow none yields.
std::vector<MaterialLaw> material_laws(const Aggregate& matter, Flow flow = Flow::trial);
// The volume below which the guard acts on a cell (laws/volume_guard.h).
double guarded_volume(const MaterialLaw& law);

}  // namespace swage
