// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_meshes.h"

#include <fmt/format.h>

#include "geometry/mesh_write.h"
#include "pipeline/made_folder.h"
#include "pipeline/piece_fields.h"
#include "pipeline/run_directory.h"
#include "scene/product_names.h"
#include "skin/cut_layout.h"
#include "skin/skin_pieces.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// OBJ has no place for fields.
void write_meshes(const WorkPiece& body, const std::vector<SkinField>& fields,
                  const SkinFieldValues& values, const fs::path& stem) {
    std::vector<VertexValues> of_vertices;
    for (std::size_t f = 0; f < fields.size(); ++f) {
        const SkinFieldWords& words = words_of(fields[f]);
        std::string comment = fmt::format("{}: {}", words.name, words.title);
        if (*words.unit != 0) comment += fmt::format(" [{}]", words.unit);
        of_vertices.push_back({words.name, std::move(comment), &values[f]});
    }
    TriMesh mesh = body.deformed();
    write_ply(fs::path(stem) += ".ply", mesh, of_vertices);
    mesh.position = body.skin.position;
    lay_out_cuts(mesh);
    mesh.position = body.position;
    const std::vector<int> piece = skin_pieces(body.skin, body.mount, body.matter);
    // The scene has no other of that name (refuse_same_files()).
    write_obj(fs::path(stem) += ".obj", mesh, objects_of_pieces(mesh, piece, body.label),
              LibraryPlace::is_its_own);
}

}  // namespace

StageMeshes::StageMeshes(const SceneSpec& scene, const StageSpec& stage, const fs::path& root)
    : scene_(scene) {
    for (const BodySpec& body : scene.body) {
        stem_.push_back(root / "meshes" / mesh_name(scene, stage, body));
    }
}

void StageMeshes::make_folders() const {
    if (!scene_.output.meshes_per_frame) return;
    for (const fs::path& folder : stem_) make_folder(folder);
}

void StageMeshes::write_frame(int frame, const std::vector<WorkPiece>& bodies,
                              const std::vector<SkinFieldValues>& values) const {
    if (!scene_.output.meshes_per_frame) return;
    const std::string name = frame_name(frame, scene_.render.first_frame);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        write_meshes(bodies[b], scene_.output.fields, values[b], stem_[b] / name);
    }
}

void StageMeshes::write_end(std::size_t body, const WorkPiece& piece) const {
    const std::vector<SkinField>& fields = scene_.output.fields;
    write_meshes(piece, fields, fields_on_skin(piece, fields), stem_[body]);
}

}  // namespace swage
