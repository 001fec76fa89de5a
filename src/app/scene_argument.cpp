// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene_argument.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/command.h"
#include "base/error.h"
#include "base/log.h"

namespace swage {

namespace {

// Who gives a run where a scene is wanted may want to know of it.
void refuse_run(const std::filesystem::path& file) {
    constexpr const char* kRecord = "run.json";
    std::error_code none;
    const bool is_folder = std::filesystem::is_directory(file, none);
    if (!std::filesystem::is_regular_file(is_folder ? file / kRecord : file, none)) return;
    if (!is_folder && file.filename() != kRecord) return;
    const std::filesystem::path folder = is_folder ? file : file.parent_path();
    fail(ExitCode::scene, "{} is a run, no scene: `swage info {}` tells of it", file.string(),
         folder.empty() ? "." : folder.string());
}

}  // namespace

void add_assets_option(CLI::App& command, std::string& assets) {
    command.add_option("--assets", assets, "folder that contains machines/ and assets/")
        ->type_name("DIR");
}

AssetPaths asset_paths(const std::string& given) {
    if (given.empty()) return find_assets();
    return find_assets(std::filesystem::path(given));
}

void add_scene_argument(CLI::App& command, SceneArgument& argument) {
    command.add_option("scene", argument.file, "scene file (TOML), or - for standard input")
        ->required()
        ->type_name("SCENE");
    command
        .add_option("--set", argument.overrides,
                    "override a value of the scene, such as \"stage.1.angle=45 deg\"; of several "
                    "stages, bodies and the like, by number in the scene file (body.1 is its first "
                    "[[body]]), by name (body.body-2 is the same if it has none), by machine, or * "
                    "for all")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    add_assets_option(command, argument.assets);
}

SceneReading read_scene_argument(const SceneArgument& argument) {
    refuse_run(argument.file);
    return read_scene(argument.file, argument.overrides, asset_paths(argument.assets));
}

void log_mistakes(const std::vector<Mistake>& mistakes) {
    for (const Mistake& mistake : mistakes) log_text(mistake_text(mistake));
}

SceneSpec scene_of(SceneReading reading, const SceneArgument& argument) {
    const auto count = std::count_if(reading.mistakes.begin(), reading.mistakes.end(),
                                     [](const Mistake& mistake) { return !mistake.warning; });
    if (count > 0 || !reading.scene) {
        fail(exit_code(reading.mistakes), "{}: {} mistake{}; nothing was run", argument.file, count,
             count == 1 ? "" : "s");
    }
    return std::move(*reading.scene);
}

Json mistakes_json(const std::vector<Mistake>& mistakes) {
    Json list = Json::array();
    for (const Mistake& mistake : mistakes) {
        list.push_back({{"file", mistake.file.string()},
                        {"line", mistake.line},
                        {"column", mistake.column},
                        {"text", mistake.text},
                        {"warning", mistake.warning}});
    }
    return list;
}

std::vector<Mistake> mistakes_of(const std::exception& error, const SceneArgument& argument) {
    if (const auto* placed = dynamic_cast<const SceneError*>(&error)) return placed->mistakes();
    return {{.file = argument.file, .text = error.what()}};
}

}  // namespace swage
