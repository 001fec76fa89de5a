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

// The machines that a scene in `scene_folder` can name, sorted by name: those in its own folder
// `machines/`, then those of every root; the first of a name wins. Without a folder: the roots'.
std::vector<MachineFile> known_machines(const AssetPaths& assets,
                                        const std::filesystem::path& scene_folder = {});

// Material files in the order in which a name is looked up: materials.toml beside the scene, then
// assets/materials.toml of every root.
std::vector<std::filesystem::path> material_files(const AssetPaths& assets,
                                                  const std::filesystem::path& scene_folder = {});

}  // namespace swage
