// SPDX-License-Identifier: GPL-3.0-or-later
// What there is to choose from: machines and materials.
#pragma once

#include <optional>
#include <vector>

#include "geometry/trimesh.h"
#include "matter/material.h"
#include "scene/find.h"
#include "scene/mistake.h"
#include "scene/read_machine.h"

namespace swage {

struct MachineCatalogue {
    std::vector<MachineSpec> machine;   // sorted by name
    std::vector<MachineFile> unusable;  // no machine can be made of these
    std::vector<Mistake> mistakes;
};
// With a folder: also those in its machines/, which a scene there can name. `only`: that of this
// name, if any; others are not read.
MachineCatalogue machine_catalogue(const AssetPaths& assets,
                                   const std::filesystem::path& scene_folder,
                                   const std::string& only = {});

struct MaterialCatalogue {
    std::vector<Material> material;                    // in the order of the files
    std::vector<std::optional<SurfaceMaterial>> look;  // of each, where its file says
    std::vector<Mistake> mistakes;
    std::vector<std::filesystem::path> files;  // those that were read
};
// With a folder: also the materials beside a scene there.
MaterialCatalogue material_catalogue(const AssetPaths& assets,
                                     const std::filesystem::path& scene_folder);

}  // namespace swage
