// SPDX-License-Identifier: GPL-3.0-or-later
// A skin with an image that exports are tried with.
#pragma once

#include <filesystem>

#include "geometry/trimesh.h"

namespace swage::test {

// Open, of a square and two triangles.
TriMesh pyramid(const std::filesystem::path& texture);
// With a face more, of a cut.
TriMesh with_cut(TriMesh pyramid);

}  // namespace swage::test
