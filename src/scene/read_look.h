// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "geometry/trimesh.h"
#include "scene/table_reader.h"

namespace swage {

// `look` of a material, if the table has it: over what `look` has, else from a colour on.
void read_look(TableReader& table, std::optional<SurfaceMaterial>& look);

}  // namespace swage
