// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/catalogue.h"
#include "scene/spec.h"
#include "scene/table_reader.h"

namespace swage {

// One [[inset]] of a scene.
// Keys of [material] that an inset has not.
const std::vector<std::string>& keys_of_whole_bodies();

InsetSpec read_inset(TableReader& table, const AssetPaths& assets,
                     const std::filesystem::path& scene_folder,
                     std::vector<std::filesystem::path>& inputs);

// What a scene with insets cannot ask for; told at its [[inset]].
void refuse_with_insets(TableReader& root, const SceneSpec& scene);

}  // namespace swage
