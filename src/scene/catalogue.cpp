// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/catalogue.h"

#include <algorithm>
#include <utility>

#include "scene/document.h"
#include "scene/read_look.h"
#include "scene/read_material.h"
#include "scene/table_reader.h"

namespace swage {

MachineCatalogue machine_catalogue(const AssetPaths& assets,
                                   const std::filesystem::path& scene_folder,
                                   const std::string& only) {
    MachineCatalogue catalogue;
    for (const MachineFile& known : known_machines(assets, scene_folder)) {
        if (!only.empty() && known.name != only) continue;
        MachineReading reading = read_machine(known.file);
        if (reading.machine) {
            catalogue.machine.push_back(std::move(*reading.machine));
        } else {
            catalogue.unusable.push_back(known);
        }
        catalogue.mistakes.insert(catalogue.mistakes.end(), reading.mistakes.begin(),
                                  reading.mistakes.end());
    }
    return catalogue;
}

MaterialCatalogue material_catalogue(const AssetPaths& assets,
                                     const std::filesystem::path& scene_folder) {
    MaterialCatalogue catalogue;
    for (const std::filesystem::path& file : material_files(assets, scene_folder)) {
        MistakeList mistakes;
        Reading reading(mistakes);
        const std::filesystem::path shown = shown_path(file);
        const std::optional<Document> document = read_document(file, shown, mistakes);
        if (document) {
            reading.is_complete = document->is_complete;
            for (const Entry& entry : document->root.entry) {
                if (entry.value.kind != Node::Kind::table) {
                    mistakes.add(
                        entry.place,
                        fmt::format("\"{}\" is outside any material: write [NAME] above it",
                                    entry.key));
                    continue;
                }
                Material material;
                material.name = entry.key;
                TableReader table(entry.value, "[" + entry.key + "]", reading);
                read_material_numbers(table, true, material);
                std::optional<SurfaceMaterial> look;
                read_look(table, look);
                table.finish();
                // The scene's own come first, and stand in for those that ship.
                const bool is_known =
                    std::any_of(catalogue.material.begin(), catalogue.material.end(),
                                [&](const Material& one) { return one.name == material.name; });
                if (is_known) continue;
                catalogue.material.push_back(std::move(material));
                catalogue.look.push_back(std::move(look));
            }
            reading.known.clear();  // one material's keys belong in no other
            reading.report_unknown();
            catalogue.files.push_back(file);
        }
        const std::vector<Mistake> found = mistakes.take(shown);
        catalogue.mistakes.insert(catalogue.mistakes.end(), found.begin(), found.end());
    }
    return catalogue;
}

}  // namespace swage
