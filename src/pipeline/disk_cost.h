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
    double frames, stills, cells, particles;
    double matter;       // [byte] in memory
    double vertices;     // of skins
    double seconds = 0;  // of simulation, at the most
    double faces = 0;    // of cells, as the bodies' surfaces have area for
};

// That skins have more of where all that may break is broken to its particles; `vertices` and
// `faces`: as DiskShare has them.
double broken_vertices(const SceneSpec& scene, double particles, double vertices, double faces);

// What is kept of a run after a stage [byte].
double checkpoint_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input,
                        const DiskShare& of);

// [byte], when the directory holds the most.
double disk_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input, DiskShare of);

// [byte], of what no run can do without: where there is no room for what is kept to go on from, it
// goes on without that. Nothing has broken.
double least_disk_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input,
                        const DiskShare& of);

}  // namespace swage
