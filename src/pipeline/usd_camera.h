// SPDX-License-Identifier: GPL-3.0-or-later
// Camera and key lamp of a run's stills in USD.
#pragma once

#include "geometry/usd_text.h"
#include "pipeline/run_options.h"
#include "pipeline/shot.h"

namespace swage {

// Into the prim that is open, which has the world's axes. `count`: of the run's frames; `seen`: the
// box of all that is there but what goes on without end, `all`: with that.
void write_usd_view(UsdText& out, const Shot& shot, int count, const FrameRange& frames,
                    const Box& seen, const Box& all);

}  // namespace swage
