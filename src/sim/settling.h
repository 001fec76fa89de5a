// SPDX-License-Identifier: GPL-3.0-or-later
// One relaxation to rest: downhill with momentum (sim/relaxation_schedule.h), with a mass for each
// particle under which a step of one is stable everywhere, and by the stiffness for the slow
// motions of the body as a whole (sim/coarse_space.h).
#pragma once

#include "sim/coarse_space.h"
#include "sim/static_forces.h"
#include "sim/static_move.h"

namespace swage {

// Moves the particles until no more than `accuracy` of the forces is left over, a share of the
// largest push. `limit`: iterations, which may be more where the body is still on its way.
// `coarse`: of what is whole; may know its stiffness from before.
Relaxation settle(StaticForces& forces, CoarseSpace& coarse, const StaticMove& move,
                  double accuracy, int limit);

}  // namespace swage
