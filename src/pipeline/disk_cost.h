// SPDX-License-Identifier: GPL-3.0-or-later
// What a run directory will hold. Measured on shipped scenes and small ones: seldom less, and up to
// twice what comes of it; more where matter could break in every frame and does not.
#pragma once

#include <vector>

#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

// Of all bodies together.
struct DiskShare {
    double frames, stills, cells;
    double vertices;  // of skins
};

// [byte]
double disk_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input, const DiskShare& of);

}  // namespace swage
