// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/find.h"

#include <algorithm>
#include <cstdlib>

#include "base/error.h"
#include "base/suggest.h"
#include "base/text.h"

namespace swage {

namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
    std::error_code error;
    return fs::is_directory(path, error);
}

void add_root(std::vector<fs::path>& root, const fs::path& path) {
    if (!is_folder(path)) return;
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(path, error);
    const fs::path& known = error ? path : whole;
    if (std::find(root.begin(), root.end(), known) == root.end()) root.push_back(known);
}

std::vector<std::string> names_of(const std::vector<MachineFile>& machines) {
    std::vector<std::string> names;
    for (const MachineFile& one : machines) names.push_back(one.name);
    return names;
}

}  // namespace

AssetPaths find_assets(const std::optional<fs::path>& given) {
    AssetPaths assets;
    if (given) {
        if (!is_folder(*given)) {
            fail(ExitCode::command_line, "the assets folder \"{}\" does not exist",
                 given->string());
        }
        add_root(assets.root, *given);
    }
    if (const char* named = std::getenv("SWAGE_ASSETS"); named != nullptr && *named != '\0') {
        if (!is_folder(named)) {
            fail(ExitCode::command_line,
                 "the assets folder \"{}\" named by SWAGE_ASSETS does not exist", named);
        }
        add_root(assets.root, named);
    }
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (!error) {
        const fs::path folder = program.parent_path();
        add_root(assets.root, folder / "../share/swage");
        if (is_folder(folder / "../../machines")) add_root(assets.root, folder / "../..");
    }
    return assets;
}

std::vector<fs::path> machine_folders(const AssetPaths& assets, const fs::path& scene_folder) {
    std::vector<fs::path> folders;
    if (!scene_folder.empty()) folders.push_back(scene_folder / "machines");
    for (const fs::path& root : assets.root) folders.push_back(root / "machines");
    return folders;
}

std::vector<MachineFile> known_machines(const AssetPaths& assets, const fs::path& scene_folder) {
    std::vector<MachineFile> found;
    for (const fs::path& folder : machine_folders(assets, scene_folder)) {
        std::error_code error;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
            const fs::path& file = entry.path();
            if (file.extension() != ".toml" || !entry.is_regular_file(error)) continue;
            const std::string name = file.stem().string();
            const bool is_known =
                std::any_of(found.begin(), found.end(),
                            [&](const MachineFile& one) { return one.name == name; });
            if (!is_known) found.push_back({name, file});
        }
    }
    std::sort(found.begin(), found.end(),
              [](const MachineFile& a, const MachineFile& b) { return a.name < b.name; });
    return found;
}

std::string names_text(const std::vector<MachineFile>& machines) {
    return machines.empty() ? "none" : joined(names_of(machines), ", ");
}

std::string names_text(const std::vector<fs::path>& folders) {
    std::vector<std::string> names;
    for (const fs::path& folder : folders) names.push_back(folder.string());
    return joined(names, ", ");
}

std::string no_machine_text(const std::string& wanted, const std::vector<MachineFile>& known,
                            const std::vector<fs::path>& folders) {
    const std::string hint = did_you_mean(wanted, names_of(known));
    std::vector<fs::path> roots;
    for (const fs::path& folder : folders) roots.push_back(folder.parent_path());
    return fmt::format("there is no machine \"{}\"{}{}: {}; looked in {}{}", wanted, hint,
                       hint.empty() ? "; known" : " Known", names_text(known), names_text(folders),
                       wrong_root_text(roots));
}

std::string wrong_root_text(const std::vector<fs::path>& roots) {
    if (roots.empty()) {
        return "; there are none beside this program: set SWAGE_ASSETS (or --assets) to the folder "
               "that contains machines and assets";
    }
    for (const fs::path& root : roots) {
        const fs::path above = root.parent_path();
        if (root.filename() != "assets" || is_folder(root / "machines") ||
            !is_folder(above / "machines")) {
            continue;
        }
        return fmt::format(
            "; set SWAGE_ASSETS (or --assets) to {}, which contains machines and assets, not to {}",
            above.empty() ? "." : above.string(), root.string());
    }
    return {};
}

std::vector<fs::path> material_files(const AssetPaths& assets, const fs::path& scene_folder) {
    std::vector<fs::path> candidates, files;
    if (!scene_folder.empty()) candidates.push_back(scene_folder / "materials.toml");
    for (const fs::path& root : assets.root) candidates.push_back(root / "assets/materials.toml");
    for (const fs::path& file : candidates) {
        std::error_code error;
        if (fs::exists(file, error)) files.push_back(file);
    }
    return files;
}

}  // namespace swage
