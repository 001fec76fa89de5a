// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes that a scene names, as they are read and made fit to be molded.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/crease_angle.h"
#include "geometry/mesh_check.h"
#include "geometry/trimesh.h"
#include "mold/mold.h"
#include "scene/spec.h"

namespace swage {

struct InputMesh {
    TriMesh mesh;       // read and scaled; repaired, where that keeps what it looks like
    TriMesh solid;      // what bounds the volume to be molded; empty: the mesh itself does
    MeshReport report;  // of the mesh as it was read
    std::vector<std::string> finding;  // what the file held and the mesh does not, and the like
    std::vector<std::string> repair;   // account; empty when nothing was repaired
    double scale = 1;                  // from the file's lengths to ours

    const TriMesh& to_mold() const { return solid.triangle.empty() ? mesh : solid; }
};

// Reads, scales to `length` (the longest side of the box [m]) and reports. Throws Error(mesh).
// `crease_angle`: as SkinSettings has it; `looks`: as read_mesh() has it.
InputMesh read_mesh_as_it_is(const std::filesystem::path& file, std::optional<double> length,
                             double crease_angle = kCreaseAngle, bool looks = true);

// The same, and makes sure that it can be molded. Logs one line always, and the account of a
// repair, not what is found.
InputMesh read_input_mesh(const MeshSpec& spec, MoldKind kind, double crease_angle = kCreaseAngle,
                          bool looks = true);

// Repairs a mesh that does not bound a volume, and one whose bodies make it a wrong one. A block is
// molded over the box alone.
void make_solid(InputMesh& input, MoldKind kind, double crease_angle = kCreaseAngle);

// The meshes of all bodies of a scene, those of one file read once. Warns of what is found.
std::vector<InputMesh> read_input_meshes(const SceneSpec& scene);

}  // namespace swage
