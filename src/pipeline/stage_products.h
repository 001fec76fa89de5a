// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes and tables that stages leave in a run directory.
#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/run_directory.h"
#include "scene/spec.h"

namespace swage {

// Of so many first stages, from the run's root on and without endings.
std::vector<std::filesystem::path> products_of_stages(const SceneSpec& scene, int stages);

// One of these that is not there any more; empty: all are.
std::filesystem::path missing_product(const SceneSpec& scene, const RunDirectory& directory,
                                      int stages);

}  // namespace swage
