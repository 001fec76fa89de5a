// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_looks.h"

#include <algorithm>
#include <map>
#include <optional>

#include "geometry/shown_color.h"

namespace swage {

namespace {

constexpr double kAlike = 1e-5;  // colours; those of vertices that cuts make are rounded

bool is_alike(const Vec3& a, const Vec3& b) { return (a - b).cwiseAbs().maxCoeff() < kAlike; }

bool is_same(const SurfaceMaterial& a, const SurfaceMaterial& b) {
    const auto& image_a = a.embedded_texture;
    const auto& image_b = b.embedded_texture;
    return a.name == b.name && is_alike(a.color, b.color) && a.roughness == b.roughness &&
           a.metallic == b.metallic && a.clear == b.clear && a.texture == b.texture &&
           (image_a == image_b || (image_a && image_b && *image_a == *image_b));
}

// Of all that a material covers; none where it differs.
std::optional<Vec3> only_color(const TriMesh& mesh, const SurfaceMaterial& material) {
    std::optional<Vec3> only;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        if (&material_of(mesh, t) != &material) continue;
        for (const int v : mesh.triangle[t]) {
            const Vec3 here = shown_color(mesh, t, v).cast<double>();
            if (!only) only = here;
            if (!is_alike(*only, here)) return std::nullopt;
        }
    }
    return only;
}

}  // namespace

std::string name_of(const SurfaceMaterial& material) {
    return material.name.empty() ? "material" : material.name;
}

bool has_image(const SurfaceMaterial& material) {
    return !material.texture.empty() || material.embedded_texture != nullptr;
}

int MeshLooks::number_of(SurfaceMaterial material, bool reads_colors) {
    const auto known = std::find_if(look_.begin(), look_.end(), [&](const Look& look) {
        return look.reads_colors == reads_colors && is_same(look.material, material);
    });
    if (known != look_.end()) return static_cast<int>(known - look_.begin());
    look_.push_back({std::move(material), reads_colors});
    return static_cast<int>(look_.size()) - 1;
}

std::vector<int> MeshLooks::of_polygons(const TriMesh& mesh, const PolygonCorners& polygons) {
    std::vector<int> look(polygons.count(), -1);
    if (mesh.material.empty()) return look;
    std::map<std::pair<int, bool>, int> known;
    for (std::size_t p = 0; p < polygons.count(); ++p) {
        const auto has_no_uv = [&](int corner) {
            return mesh.triangle_uv.empty() || mesh.triangle_uv[corner / 3][corner % 3] < 0;
        };
        const auto begin = polygons.corner.begin() + std::ptrdiff_t(polygons.first[p]);
        const auto end = polygons.corner.begin() + std::ptrdiff_t(polygons.first[p + 1]);
        const int m = mesh.triangle_material.empty() ? 0 : mesh.triangle_material[*begin / 3];
        const bool is_bare = has_image(mesh.material.at(m)) && std::any_of(begin, end, has_no_uv);
        auto [at, is_new] = known.try_emplace({m, is_bare}, -1);
        if (is_new) {
            SurfaceMaterial material = mesh.material[m];
            if (is_bare) material.texture.clear(), material.embedded_texture.reset();
            const bool takes_colors = material.takes_colors && !mesh.position_color.empty();
            const bool reads_colors = takes_colors && (images_take_colors_ || !has_image(material));
            if (takes_colors && !reads_colors) {
                if (const auto only = only_color(mesh, mesh.material[m])) {
                    material.color = *only;
                } else {
                    without_colors_.insert(name_of(material));
                }
            }
            at->second = number_of(std::move(material), reads_colors);
        }
        look[p] = at->second;
    }
    return look;
}

std::vector<SurfaceMaterial> MeshLooks::materials() const {
    std::vector<SurfaceMaterial> all;
    for (const Look& look : look_) all.push_back(look.material);
    return all;
}

}  // namespace swage
