// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "geometry/trimesh.h"

namespace swage {

// Places and triangles of a file by its own vertex numbers: places that coincide stay apart. Throws
// as read_mesh() does.
TriMesh read_as_numbered(const std::filesystem::path& file);

}  // namespace swage
