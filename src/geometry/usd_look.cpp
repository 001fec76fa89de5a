// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/usd_look.h"

namespace swage {

namespace {

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

std::vector<std::string> usd_identifiers(const MeshLooks& looks) {
    std::vector<std::string> identifier;
    std::set<std::string> taken;
    for (const MeshLooks::Look& look : looks.all()) {
        identifier.push_back(usd_identifier(name_of(look.material), taken));
    }
    return identifier;
}

// NOTE: UsdPreviewSurface multiplies no colours; an image goes before those of vertices.
void write_usd_looks(UsdText& out, const MeshLooks& looks, const std::string& path,
                     const std::vector<std::string>& image) {
    const std::vector<std::string> identifier = usd_identifiers(looks);
    for (std::size_t n = 0; n < identifier.size(); ++n) {
        const MeshLooks::Look& look = looks.all()[n];
        const std::string own = path + "/" + identifier[n];
        const auto connection = [&](const char* shader, const char* output) {
            return fmt::format(".connect = <{}/{}.outputs:{}>", own, shader, output);
        };
        out.open(usd_prim("Material", name_of(look.material), identifier[n]));
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
