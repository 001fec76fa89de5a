// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/material.h"
#include "scene/catalogue.h"
#include "scene/table_reader.h"

namespace swage {

// Times more or less than what a known material has: a unit is missing.
inline constexpr double kOtherMatter = 600;

// Reads the numbers of a material over those that `material` has; `needs_all` asks for those that
// nothing can stand in for.
void read_material_numbers(TableReader& table, bool needs_all, Material& material);

// The section [material] of a scene: a known material, with its own numbers over it, or a custom
// one, and how it looks, where that is told. Materials are looked up when a name asks for one.
// `is_there`: neither the file nor an override gives the section where not.
void read_material(TableReader& table, const AssetPaths& assets,
                   const std::filesystem::path& scene_folder, Material& material,
                   std::optional<SurfaceMaterial>& look, std::vector<std::filesystem::path>& inputs,
                   bool is_there = true);

}  // namespace swage
