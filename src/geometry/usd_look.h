// SPDX-License-Identifier: GPL-3.0-or-later
// Materials of meshes as USD has them: each a UsdPreviewSurface, with the image that it has beside
// the file.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh_looks.h"
#include "geometry/usd_text.h"

namespace swage {

std::vector<std::string> usd_identifiers(const MeshLooks& looks);

// The prims, at `path`; `image`: the name of the file of each, empty for none.
void write_usd_looks(UsdText& out, const MeshLooks& looks, const std::string& path,
                     const std::vector<std::string>& image);

}  // namespace swage
