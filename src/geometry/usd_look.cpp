// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/usd_look.h"

#include <algorithm>
#include <map>
#include <optional>

#include "geometry/shown_color.h"

namespace swage {

namespace {

constexpr double kAlike = 1e-5;  // colours; those of vertices that cuts make are rounded

std::string name_of(const SurfaceMaterial& material) {
    return material.name.empty() ? "material" : material.name;
}

bool has_image(const SurfaceMaterial& material) {
    return !material.texture.empty() || material.embedded_texture != nullptr;
}

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

std::string color_text(const Vec3& color) {
    return fmt::format("{}, {}, {}", float(color[0]), float(color[1]), float(color[2]));
}

void write_shader(UsdText& out, const char* name, const char* kind, const std::string& lines) {
    out.open(fmt::format("def Shader \"{}\"", name));
    out.line(fmt::format("uniform token info:id = \"{}\"", kind));
    out.line(lines);
    out.close();
}

}  // namespace

int UsdLooks::number_of(SurfaceMaterial material, bool reads_colors) {
    const auto known = std::find_if(look_.begin(), look_.end(), [&](const Look& look) {
        return look.reads_colors == reads_colors && is_same(look.material, material);
    });
    if (known != look_.end()) return static_cast<int>(known - look_.begin());
    const std::string identifier = usd_identifier(name_of(material), taken_);
    look_.push_back({std::move(material), reads_colors, identifier});
    return static_cast<int>(look_.size()) - 1;
}

std::vector<int> UsdLooks::of_polygons(const TriMesh& mesh, const PolygonCorners& polygons) {
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
            const bool reads_colors = takes_colors && !has_image(material);
            if (takes_colors && !reads_colors) {
                // NOTE: UsdPreviewSurface multiplies no colours; an image goes before those of
                // vertices.
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

std::vector<SurfaceMaterial> UsdLooks::materials() const {
    std::vector<SurfaceMaterial> all;
    for (const Look& look : look_) all.push_back(look.material);
    return all;
}

void UsdLooks::write(UsdText& out, const std::string& path,
                     const std::vector<std::string>& image) const {
    for (std::size_t n = 0; n < look_.size(); ++n) {
        const Look& look = look_[n];
        const std::string own = path + "/" + look.identifier;
        const auto connection = [&](const char* shader, const char* output) {
            return fmt::format(".connect = <{}/{}.outputs:{}>", own, shader, output);
        };
        out.open(usd_prim("Material", name_of(look.material), look.identifier));
        out.line("token outputs:surface" + connection("surface", "surface"));
        std::string diffuse = fmt::format(" = ({})", color_text(look.material.color));
        if (!image[n].empty()) diffuse = connection("image", "rgb");
        if (look.reads_colors) diffuse = connection("colors", "result");
        write_shader(
            out, "surface", "UsdPreviewSurface",
            fmt::format("color3f inputs:diffuseColor{}\nfloat inputs:metallic = {}\n"
                        "float inputs:roughness = {}\n{}token outputs:surface",
                        diffuse, float(look.material.metallic), float(look.material.roughness),
                        look.material.clear > 0 ? fmt::format("float inputs:opacity = {}\n",
                                                              float(1 - look.material.clear))
                                                : ""));
        if (!image[n].empty()) {
            std::string scale;
            if (look.material.color != Vec3::Ones()) {
                scale =
                    fmt::format("float4 inputs:scale = ({}, 1)\n", color_text(look.material.color));
            }
            write_shader(
                out, "image", "UsdUVTexture",
                fmt::format("asset inputs:file = {}\n{}"
                            "token inputs:sourceColorSpace = \"sRGB\"\n"
                            "float2 inputs:st{}\n"
                            "token inputs:wrapS = \"repeat\"\n"
                            "token inputs:wrapT = \"repeat\"\n"
                            "float3 outputs:rgb",
                            usd_asset("./" + image[n]), scale, connection("place", "result")));
            write_shader(out, "place", "UsdPrimvarReader_float2",
                         "string inputs:varname = \"st\"\nfloat2 outputs:result");
        } else if (look.reads_colors) {
            write_shader(out, "colors", "UsdPrimvarReader_float3",
                         fmt::format("float3 inputs:fallback = ({})\n"
                                     "string inputs:varname = \"displayColor\"\n"
                                     "float3 outputs:result",
                                     color_text(look.material.color)));
        }
        out.close();
    }
}

}  // namespace swage
