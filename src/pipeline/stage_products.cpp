// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_products.h"

#include <string>

#include "scene/product_names.h"

namespace swage {

namespace fs = std::filesystem;

std::vector<fs::path> products_of_stages(const SceneSpec& scene, int stages) {
    const fs::path meshes = "meshes", curves = "curves";
    std::vector<fs::path> products;
    for (int s = 0; s < stages; ++s) {
        const StageSpec& stage = scene.stage[static_cast<std::size_t>(s)];
        for (const std::string& table : table_names(stage)) products.push_back(curves / table);
        for (const BodySpec& body : scene.body) {
            products.push_back(meshes / mesh_name(scene, stage, body));
        }
    }
    return products;
}

fs::path missing_product(const SceneSpec& scene, const RunDirectory& directory, int stages) {
    for (const fs::path& product : products_of_stages(scene, stages)) {
        const bool is_mesh = product.parent_path() == "meshes";
        for (const char* ending : is_mesh ? std::vector{".obj", ".ply"} : std::vector{".csv"}) {
            const fs::path file = directory.root() / fs::path(product).concat(ending);
            std::error_code error;
            if (!fs::exists(file, error)) return file;
        }
    }
    return {};
}

}  // namespace swage
