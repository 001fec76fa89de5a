// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/body_look.h"

namespace swage {

namespace {

constexpr double kMetalRoughness = 0.35;

bool says_none(const TriMesh& mesh) { return mesh.material.empty() && mesh.position_color.empty(); }

bool is_metal(const SurfaceMaterial& look) { return look.metallic > 0.5; }

}  // namespace

std::optional<SurfaceMaterial> body_look(const BodySpec& body, const TriMesh& mesh) {
    if (body.color) {
        SurfaceMaterial look;
        look.color = *body.color;
        if (body.metal.value_or(false)) {
            look.metallic = 1;
            look.roughness = kMetalRoughness;
        } else if (!body.metal && body.look && !is_metal(*body.look)) {
            look.roughness = body.look->roughness;
            look.clear = body.look->clear;
        }
        return look;
    }
    return body.wears_material || says_none(mesh) ? body.look : std::nullopt;
}

void color_inside(const BodySpec& body, TriMesh& mesh) {
    if (!body.cut_color) return;
    if (mesh.material.empty()) mesh.material.emplace_back();
    for (SurfaceMaterial& material : mesh.material) material.inside = body.cut_color;
}

bool hides_material(const BodySpec& body, const TriMesh& mesh) {
    return body.look && !body.color && !body.wears_material && !says_none(mesh);
}

}  // namespace swage
