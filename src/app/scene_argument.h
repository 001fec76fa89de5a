// SPDX-License-Identifier: GPL-3.0-or-later
// The scene of a command: its file and what the user sets over it.
#pragma once

#include <CLI/CLI.hpp>
#include <exception>
#include <string>
#include <vector>

#include "pipeline/json.h"
#include "scene/find.h"
#include "scene/read_scene.h"

namespace swage {

struct SceneArgument {
    std::string file, assets;
    std::vector<std::string> overrides;  // key=value
};

void add_assets_option(CLI::App& command, std::string& assets);
AssetPaths asset_paths(const std::string& given);  // empty: the usual places

void add_scene_argument(CLI::App& command, SceneArgument& argument);

// All that is to be said of the scene; nothing is logged.
SceneReading read_scene_argument(const SceneArgument& argument);

// Every mistake on stderr, one a line, as FILE:LINE:COLUMN: what.
void log_mistakes(const std::vector<Mistake>& mistakes);

// Throws Error with the count of mistakes, or gives the scene.
SceneSpec scene_of(SceneReading reading, const SceneArgument& argument);

// What --json tells of a scene that cannot be run.
Json mistakes_json(const std::vector<Mistake>& mistakes);
// What came to light after the scene was read; of what has no place in it, the sentence.
std::vector<Mistake> mistakes_of(const std::exception& error, const SceneArgument& argument);

}  // namespace swage
