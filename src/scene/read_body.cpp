// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_body.h"

#include <algorithm>

#include "scene/file_text.h"
#include "scene/read_color.h"
#include "scene/read_material.h"
#include "scene/read_stage.h"

namespace swage {

namespace {

namespace fs = std::filesystem;

constexpr int kDefaultAcross = 6;

void read_file(TableReader& table, const fs::path& folder, const char* what, MeshSpec& mesh) {
    std::string file;
    if (table.text("file", file)) {
        mesh.file = (folder / file).lexically_normal();
        if (file.empty()) {
            if (table.find("file")->kind == Node::Kind::text) {
                table.mistake("file", "the mesh's file name is empty");
            }
        } else if (const auto reason = why_no_mesh(mesh.file)) {
            table.mistake("file",
                          fmt::format("the mesh \"{}\" {} ({})", file, *reason, mesh.file.string()),
                          ExitCode::mesh);
        }
    } else if (table.place().line == 0) {
        if (table.reading().is_complete) {
            table.mistake("file",
                          "the section [mesh] is missing: it needs a file, such as "
                          "file = \"bar.obj\"");
        }
    } else {
        table.missing("file", what);
    }
    double length = 0;
    if (table.quantity("length", Quantity::length, above(0), length) && length > 0) {
        mesh.length = length;
    }
}

void read_texture(TableReader& table, const fs::path& folder, BodySpec& body) {
    std::string file;
    if (!table.text("texture", file)) return;
    body.mesh.texture = (folder / file).lexically_normal();
    body.mesh.texture_place = table.find("texture")->place;
    if (const auto reason = why_no_texture(body.mesh.texture)) {
        table.mistake("texture", fmt::format("the texture \"{}\" {} ({})", file, *reason,
                                             body.mesh.texture.string()));
    }
}

void read_start(TableReader& table, BodySpec& body) {
    Vec3 at = Vec3::Zero();
    if (table.vector("at", Quantity::length, at)) body.start.at = at;
    table.vector("turn", Quantity::angle, body.start.turn);
    table.vector("velocity", Quantity::speed, body.start.velocity);
    table.vector("spin", Quantity::spin, body.start.spin);
}

void read_paint(TableReader& table, const fs::path& folder, BodySpec& body) {
    read_color(table, body.color);
    read_texture(table, folder, body);
    read_color(table, body.cut_color, "cut_color");
    if (table.choice<std::optional<bool>>("finish", {{"matt", false}, {"metal", true}},
                                          body.metal) &&
        !body.color && body.mesh.texture.empty()) {
        table.mistake("finish", "finish needs a color or a texture beside it");
    }
    if (body.color && !body.mesh.texture.empty()) {
        table.mistake("texture", "texture excludes a color: give one of them");
    }
    table.choice<bool>("look", {{"file", false}, {"material", true}}, body.wears_material);
}

void read_fineness(TableReader& table, BodySpec& body) {
    MoldSettings& mold = body.mold;
    int across = kDefaultAcross;
    double spacing = 0;
    bool has_across = table.whole("across", 1, 1'000'000, across);
    bool has_spacing = table.quantity("spacing", Quantity::length, above(0), spacing);
    if (has_across && has_spacing) {
        // Of an override and the file's the override counts.
        const bool sets_across = table.find("across")->place.line == 0;
        const bool sets_spacing = table.find("spacing")->place.line == 0;
        if (sets_across == sets_spacing) {
            table.mistake("spacing", "across and spacing set the same thing: give one of them");
        } else {
            (sets_across ? has_spacing : has_across) = false;
        }
    }
    if (has_spacing || has_across) {
        body.fineness_place = table.find(has_spacing ? "spacing" : "across")->place;
    }
    if (has_spacing) {
        if (spacing > 0) mold.spacing = spacing;
        mold.across.reset();
    } else if (has_across || !mold.spacing) {
        mold.across = has_across || !mold.across ? across : *mold.across;
        mold.spacing.reset();
    }
}

}  // namespace

void read_mesh_section(TableReader& table, const fs::path& scene_folder, BodySpec& body) {
    read_file(table, scene_folder, "the mesh to machine", body.mesh);
    read_start(table, body);
    read_paint(table, scene_folder, body);
    table.finish();
}

std::string usual_body_name(std::size_t number) { return fmt::format("body-{}", number); }

void refuse_look(TableReader& table, const BodySpec& body) {
    if (!body.wears_material) return;
    if (body.color) table.mistake("look", "look = \"material\" excludes a color: give one of them");
    if (!body.mesh.texture.empty()) {
        table.mistake("look", "look = \"material\" excludes a texture: give one of them");
    }
    if (!body.look) {
        table.mistake("look",
                      "look = \"material\", but the material has no look: give it one, such as "
                      "look = {color = [0.6, 0.4, 0.3], roughness = 0.8} in [material]");
    }
}

void read_mold(TableReader& table, BodySpec& body) {
    MoldSettings& mold = body.mold;
    table.choice<MoldKind>("kind", {{"shape", MoldKind::shape}, {"block", MoldKind::block}},
                           mold.kind);
    read_fineness(table, body);
    int limit = static_cast<int>(mold.cell_limit);
    if (table.whole("cell_limit", 1, 1'000'000'000, limit)) {
        body.limit_place = table.find("cell_limit")->place;
    }
    mold.cell_limit = static_cast<std::size_t>(limit);
    table.finish();
}

void BodyReader::read_name(TableReader& table, const SceneSpec& scene, BodySpec& body) {
    body.name = usual_body_name(scene.body.size() + 1);
    const bool is_named = table.text("name", body.name);
    if (const auto reason = why_no_file_name(body.name); is_named && reason) {
        table.mistake("name", fmt::format("the name {}; it is used in file names", *reason));
    } else if (std::any_of(scene.body.begin(), scene.body.end(),
                           [&](const BodySpec& other) { return other.name == body.name; })) {
        table.mistake("name", fmt::format("two bodies are called \"{}\"", body.name));
    }
}

// A name, or a table as [material] is.
void BodyReader::read_material_key(TableReader& table, SceneSpec& scene, BodySpec& body) {
    const Node* node = table.find("material");
    if (node == nullptr) return;
    Node named;
    if (node->kind == Node::Kind::text) {
        named.place = node->place;
        named.entry.push_back({"name", node->place, *node});
        node = &named;
    } else if (node->kind != Node::Kind::table) {
        table.mistake(
            "material",
            "material must be the name of one, such as \"rubber\", or a section [body.material]");
        return;
    }
    body.material = {};
    body.look.reset();
    TableReader material(*node, "[body.material]", reading_);
    read_material(material, assets_, scene_folder_, body.material, body.look, scene.inputs);
    body.gives_look = material.find("look") != nullptr;
}

void BodyReader::read(const Node& node, SceneSpec& scene) {
    TableReader table(node, "[[body]]", reading_);
    BodySpec body;
    body.material = scene.work_piece().material;
    body.look = scene.work_piece().look;
    body.gives_look = scene.work_piece().gives_look;
    body.mold = scene.work_piece().mold;
    body.fineness_place = scene.work_piece().fineness_place;
    body.limit_place = scene.work_piece().limit_place;
    read_name(table, scene, body);
    read_file(table, scene_folder_, "the mesh of the body", body.mesh);
    read_start(table, body);
    read_paint(table, scene_folder_, body);
    read_fineness(table, body);
    read_material_key(table, scene, body);
    refuse_look(table, body);
    table.finish();
    scene.body.push_back(std::move(body));
}

}  // namespace swage
