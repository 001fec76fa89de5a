// SPDX-License-Identifier: GPL-3.0-or-later
// Closed surfaces among each other: which is inside which, which way they face, where they cross.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/trimesh.h"

namespace swage {

// For closed, oriented shells: turns bodies outward (with all that is inside them, so that a cavity
// stays one), leaves out a body inside another of the same sense, unites bodies that cross (each
// less its cavities) and cavities that do. Adds a sentence to `account` for each kind of change.
// Where that cannot be done, the mesh stays as it is and the reason is returned.
std::optional<std::string> settle_bodies(TriMesh& mesh, double crease_angle,
                                         std::vector<std::string>& account);

}  // namespace swage
