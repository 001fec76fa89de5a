// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_inset.h"

#include "scene/file_text.h"
#include "scene/read_color.h"
#include "scene/read_material.h"

namespace swage {

namespace fs = std::filesystem;

const std::vector<std::string>& keys_of_whole_bodies() {
    static const std::vector<std::string> keys = {"mechanics", "friction", "static_friction",
                                                  "restitution", "stickiness"};
    return keys;
}

InsetSpec read_inset(TableReader& table, const AssetPaths& assets, const fs::path& scene_folder,
                     std::vector<fs::path>& inputs) {
    InsetSpec inset;
    std::string file;
    const bool has_file = table.text("file", file);
    if (has_file && file.empty()) {
        table.mistake("file", "the inset's file name is empty");
    } else if (has_file) {
        inset.file = (scene_folder / file).lexically_normal();
        if (const auto reason = why_no_mesh(inset.file)) {
            table.mistake(
                "file", fmt::format("the mesh \"{}\" {} ({})", file, *reason, inset.file.string()),
                ExitCode::mesh);
        }
    }
    const bool has_from = table.vector("from", Quantity::number, inset.from);
    const bool has_to = table.vector("to", Quantity::number, inset.to);
    const Node* which = table.find(has_file ? "file" : has_from ? "from" : "to");
    inset.place = which != nullptr ? which->place : table.place();
    if (has_file && (has_from || has_to)) {
        table.mistake(has_from ? "from" : "to",
                      "an inset is a mesh (file) or a box (from, to), not both");
    } else if (!has_file && !has_from && !has_to) {
        table.missing("file",
                      "the mesh of the inset; or give a box by from = [0, 0, 0.5] and to = [1, 1, "
                      "1], in fractions of the work-piece's box");
    }
    for (const char* key : {"from", "to"}) {
        const Vec3& at = key[0] == 'f' ? inset.from : inset.to;
        if ((at.array() < 0).any() || (at.array() > 1).any()) {
            table.mistake(key, fmt::format("{} = [{:g}, {:g}, {:g}]: each must be a fraction of "
                                           "the work-piece's box, 0 to 1",
                                           key, at.x(), at.y(), at.z()));
        }
    }
    if ((inset.from.array() >= inset.to.array()).any()) {
        table.mistake(has_to ? "to" : "from", "the box is empty: from must be less than to");
    }
    for (const std::string& key : keys_of_whole_bodies()) {
        if (table.find(key) == nullptr) continue;
        table.mistake(key, fmt::format("{} applies to the whole body: give it in [material]", key));
    }
    read_color(table, inset.color);
    read_material(table, assets, scene_folder, inset.material, inset.look, inputs);
    return inset;
}

void refuse_with_insets(TableReader& root, const SceneSpec& scene) {
    const BodySpec& body = scene.work_piece();
    if (body.inset.empty()) return;
    if (body.material.mechanics == Mechanics::springs) {
        root.mistake("inset",
                     "springs allow only one material: use mechanics = \"cells\" in [material]");
    }
    bool shifts = body.material.shifts();
    for (const InsetSpec& inset : body.inset) shifts = shifts || inset.material.shifts();
    if (shifts) {
        root.mistake("inset",
                     "cells of two materials have no back stress: remove back_stress from all "
                     "materials of the work-piece");
    }
}

}  // namespace swage
