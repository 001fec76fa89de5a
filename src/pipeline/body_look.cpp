// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/body_look.h"

#include <fmt/format.h>

#include <algorithm>

#include "skin/new_look.h"

namespace swage {

namespace {

constexpr double kMetalRoughness = 0.35;
constexpr double kAlike = 0.05;  // linear RGB, that colours are not told apart by
// What is like another goes this share of the way to black, or from below this to white.
constexpr double kStep = 0.6, kDark = 0.3;
constexpr int kMostSteps = 4;

bool says_none(const TriMesh& mesh) { return mesh.material.empty() && mesh.position_color.empty(); }

bool is_metal(const SurfaceMaterial& look) { return look.metallic > 0.5; }

std::string name_of(const Material& material, std::size_t number) {
    return cut_name(material.name == Material().name ? std::to_string(number) : material.name);
}

// Darker, or paler where it is dark.
Vec3 another(const Vec3& color) {
    if (color.maxCoeff() > kDark) return (1 - kStep) * color;
    return color + kStep * (Vec3::Ones() - color);
}

// `others`: of the insets before it.
SurfaceMaterial inset_look(const InsetSpec& inset, const SurfaceMaterial& cut,
                           const std::vector<SurfaceMaterial>& others) {
    SurfaceMaterial look = inset.look.value_or(cut);
    const auto is_like = [&](const SurfaceMaterial& other) {
        return (look.color - other.color).cwiseAbs().maxCoeff() < kAlike;
    };
    if (inset.color) {
        look.color = *inset.color;
        // Matt, as a body's colour is.
        if (is_metal(look)) look.roughness = SurfaceMaterial().roughness;
        look.metallic = 0;
    } else {
        // What says nothing of its look is told apart from all of them.
        const auto is_taken = [&] {
            return is_like(cut) ||
                   (!inset.look && std::any_of(others.begin(), others.end(), is_like));
        };
        for (int n = 0; n < kMostSteps && is_taken(); ++n) look.color = another(look.color);
    }
    // As a saw leaves it.
    if (is_metal(look)) look.roughness = std::max(cut.roughness, look.roughness);
    return look;
}

}  // namespace

std::optional<SurfaceMaterial> body_look(const BodySpec& body, const TriMesh& mesh) {
    if (body.color || !body.mesh.texture.empty()) {
        SurfaceMaterial look;
        look.color = body.color.value_or(Vec3::Ones());
        look.texture = body.mesh.texture;
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

std::vector<SurfaceMaterial> inset_looks(const BodySpec& body, const TriMesh& dressed) {
    const SurfaceMaterial cut = cut_look(dressed);
    std::vector<SurfaceMaterial> looks;
    for (std::size_t n = 0; n < body.inset.size(); ++n) {
        const InsetSpec& inset = body.inset[n];
        SurfaceMaterial look = inset_look(inset, cut, looks);
        look.name = name_of(inset.material, n + 1);
        look.takes_colors = false;
        const auto is_other = [&](const SurfaceMaterial& one) {
            return one.name == look.name && one.color != look.color;
        };
        // Two of one material, of colours of their own.
        if (std::any_of(looks.begin(), looks.end(), is_other)) {
            look.name = fmt::format("{}_{}", look.name, n + 1);
        }
        looks.push_back(std::move(look));
    }
    return looks;
}

bool hides_material(const BodySpec& body, const TriMesh& mesh) {
    return body.look && !body.is_painted() && !says_none(mesh);
}

}  // namespace swage
