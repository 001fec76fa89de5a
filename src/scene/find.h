// SPDX-License-Identifier: GPL-3.0-or-later
// Where machines, materials and the project's own assets are found.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace swage {

// Folders that hold `machines/` and `assets/`; the first that has a file wins.
struct AssetPaths {
    std::vector<std::filesystem::path> root;
};

// In this order: `given` (--assets), the environment's SWAGE_ASSETS, ../share/swage beside the
// executable (an installed program), ../.. of it (a build folder in the source tree). Only folders
// that exist. Throws Error(command_line) when `given` does not exist.
AssetPaths find_assets(const std::optional<std::filesystem::path>& given = std::nullopt);

struct MachineFile {
    std::string name;
    std::filesystem::path file;
};

// Where a scene in `scene_folder` finds machines, the first of a name: its own folder `machines/`,
// then that of every root. Without a folder: the roots'.
std::vector<std::filesystem::path> machine_folders(const AssetPaths& assets,
                                                   const std::filesystem::path& scene_folder);
// Those that lie there, sorted by name.
std::vector<MachineFile> known_machines(const AssetPaths& assets,
                                        const std::filesystem::path& scene_folder);

std::string names_text(const std::vector<MachineFile>& machines);  // "bend, cut", or "none"
std::string names_text(const std::vector<std::filesystem::path>& folders);
// To a user who asked for one that is none of those known from these folders.
std::string no_machine_text(const std::string& wanted, const std::vector<MachineFile>& known,
                            const std::vector<std::filesystem::path>& folders);

// To a user who gave as a root the folder `assets` of one: "; SWAGE_ASSETS (or --assets) has to be
// ..."; empty: none of these is one.
std::string wrong_root_text(const std::vector<std::filesystem::path>& roots);

// Material files in the order in which a name is looked up: materials.toml beside the scene, then
// assets/materials.toml of every root.
std::vector<std::filesystem::path> material_files(const AssetPaths& assets,
                                                  const std::filesystem::path& scene_folder);

}  // namespace swage
