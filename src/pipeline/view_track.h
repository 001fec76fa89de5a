// SPDX-License-Identifier: GPL-3.0-or-later
// The camera of a run's stills, frame by frame, as it is exported.
#pragma once

#include <vector>

#include "pipeline/run_options.h"
#include "pipeline/shot.h"
#include "render/camera.h"

namespace swage {

struct ViewTrack {
    std::vector<Pose> pose;  // in the world: it looks along its own -z with y up
    double near, far;        // [m]
    Lens lens;
};

// `count`: of the run's frames; `seen`: the box of all that is there but what goes on without end,
// `all`: with that. What is put nearer or farther afterwards is to be seen too.
ViewTrack view_track(const Shot& shot, int count, const FrameRange& frames, const Box& seen,
                     const Box& all);

}  // namespace swage
