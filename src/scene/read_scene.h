// SPDX-License-Identifier: GPL-3.0-or-later
// Scene files. Quantities carry units ("18 cm"); a bare number is SI.
// key_help.cpp says what each key is for; `swage keys` tells it, with what the key takes.
//
// Paths are relative to the file they stand in. A material may be given by its name, by the first
// two numbers and whatever else is known, or by its name with some numbers overridden.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/find.h"
#include "scene/mistake.h"
#include "scene/spec.h"
#include "scene/table_reader.h"

namespace swage {

struct SceneReading {
    std::optional<SceneSpec> scene;  // nothing when there was a mistake (not a warning)
    std::vector<Mistake> mistakes;   // of all files, the scene's first, in the order of each file
};

// What stands for standard input, whose paths are relative to the working directory.
inline constexpr const char* kPiped = "-";

// `overrides`: "stage.1.angle=45 deg", "material.young_modulus=2 GPa", "render.size=[640, 360]". A
// stage goes by its number, its name, its machine, or * for all. Everything that is wrong in the
// scene and in the files it names is found in one reading; throws nothing for what a user may
// write.
SceneReading read_scene(const std::filesystem::path& file,
                        const std::vector<std::string>& overrides, const AssetPaths& assets);

// The same of what has been parsed; paths are relative to the folder of `scene.file`.
void read_scene_document(const Document& document, const AssetPaths& assets, Reading& reading,
                         SceneSpec& scene);

}  // namespace swage
