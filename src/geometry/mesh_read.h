// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes from files. A file is read in a child process under limits, so that a broken or hostile
// one costs an error message and nothing else; what comes back is checked again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/crease_angle.h"
#include "geometry/trimesh.h"

namespace swage {

struct ReadLimits {
    std::uint64_t file_bytes = std::uint64_t{2} << 30;    // the mesh file, and each file it names
    std::uint64_t memory_bytes = std::uint64_t{8} << 30;  // of the reading process
    int cpu_seconds = 120;
    int wall_seconds = 180;
};

// OBJ, PLY, STL, OFF, glTF, GLB, DAE, 3DS and 3MF, told apart by the name's ending. Lengths are
// taken as metres (glTF is in metres; DAE and 3MF are scaled by the unit they state). Equal
// positions are welded; texture coordinates, colours, materials, parts, polygons and shading (from
// the file's normals or groups, else by `crease_angle` [rad]) are kept. Node transforms are
// applied, and what scales, shifts or turns the image of an OBJ or glTF material.
//
// `finding` receives one sentence for everything that the file held and the mesh does not, or that
// was odd; without it they are logged as warnings. `looks`: whether its look counts; else images
// are neither looked for nor told of. Throws Error(mesh): the file, the reason.
TriMesh read_mesh(const std::filesystem::path& file, const ReadLimits& limits = {},
                  std::vector<std::string>* finding = nullptr, double crease_angle = kCreaseAngle,
                  bool looks = true);

// Whether a body of the file is shaded by the angle: one that has normals or groups of its own is
// not, unless it has to be repaired. Throws as read_mesh().
bool goes_by_crease_angle(const std::filesystem::path& file);

// Whether the name ends like a mesh file that can be read: one of these.
inline constexpr const char* kMeshKinds = "OBJ, PLY, STL, OFF, glTF, GLB, DAE, 3DS, 3MF";
bool is_mesh_file_name(const std::filesystem::path& file);
// Whether its numbers may lie in other files.
bool keeps_numbers_beside(const std::filesystem::path& file);

}  // namespace swage
