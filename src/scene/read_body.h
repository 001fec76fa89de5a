// SPDX-License-Identifier: GPL-3.0-or-later
// The bodies of a scene: the work-piece, of [mesh], [material], [mold] and [[inset]], and others
// beside it, each of a [[body]].
#pragma once

#include "scene/catalogue.h"
#include "scene/spec.h"
#include "scene/table_reader.h"

namespace swage {

// The section [mesh]: the file, and where its body stands and moves at first.
void read_mesh_section(TableReader& table, const std::filesystem::path& scene_folder,
                       BodySpec& body);

// What a body is called that nobody names; the work-piece is number 1.
std::string usual_body_name(std::size_t number);

// Once its material is known.
void refuse_look(TableReader& table, const BodySpec& body);

// The section [mold].
void read_mold(TableReader& table, BodySpec& body);

// Reads the tables [[body]] of a scene whose work-piece has been read.
class BodyReader {
  public:
    BodyReader(Reading& reading, const AssetPaths& assets, std::filesystem::path scene_folder)
        : reading_(reading), assets_(assets), scene_folder_(std::move(scene_folder)) {}

    // What it leaves out of mold and material is as the work-piece has it.
    void read(const Node& node, SceneSpec& scene);

  private:
    void read_name(TableReader& table, const SceneSpec& scene, BodySpec& body);
    void read_material_key(TableReader& table, SceneSpec& scene, BodySpec& body);

    Reading& reading_;
    const AssetPaths& assets_;
    std::filesystem::path scene_folder_;
};

}  // namespace swage
