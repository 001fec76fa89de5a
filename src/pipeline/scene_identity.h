// SPDX-License-Identifier: GPL-3.0-or-later
// The identity of a run that a scene asks for (pipeline/run_identity.h).
#pragma once

#include <vector>

#include "pipeline/run_identity.h"
#include "pipeline/run_options.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

// What the scene says, hashes of every file that was read, of the mesh as it was understood, and of
// what was set on the command line.
RunIdentity identity_of(const SceneSpec& scene, const std::vector<InputMesh>& input,
                        const RunOptions& options);

}  // namespace swage
