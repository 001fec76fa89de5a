// SPDX-License-Identifier: GPL-3.0-or-later
// What a run takes of memory at its peak, by its parts. Measured as the most that a process of
// `swage run` had resident; tests/verify/COSTS.md has a table of what was told and what came.
#pragma once

#include <string>
#include <vector>

#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

// Of all bodies together.
struct MemoryShare {
    double matter = 0;  // [byte]
    double particles = 0, cells = 0;
    double faces = 0;      // of cells, that its surface is as large as
    double cut_faces = 0;  // of cells, that blades lay open
    double vertices = 0;   // of skins
    double way = 0;        // [byte], of machines
    double inset_triangles = 0;
    double carried_vertices = 0;  // of insets that go on with the matter
};

struct MemoryBytes {
    double about = 0;
    double most = 0;        // where all that may break is broken to its particles; else the same
    double undrawn = 0;     // about, of the simulation alone
    std::string less = {};  // what would take off the most of it: "a larger [mold] spacing"
};

// Of cells, on both sides of what all blades cut of the work-piece, about.
double cut_faces(const SceneSpec& scene, const TriMesh& mesh, double spacing);

// `draws`: stills too, once it is simulated.
MemoryBytes memory_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input,
                         const MemoryShare& of, bool draws);

}  // namespace swage
