// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/mesh_bytes.h"

#include "base/hash.h"

namespace swage {

void put_mesh(ByteWriter& out, const TriMesh& mesh) {
    out.put_array(mesh.position);
    out.put_array(mesh.triangle);
    out.put_array(mesh.position_color);
    out.put_array(mesh.uv);
    out.put_array(mesh.triangle_uv);
    out.put(mesh.smooth_group_count);
    out.put_array(mesh.triangle_smooth);
    out.put_array(mesh.smooth_normal);
    out.put_array(mesh.triangle_polygon);
    out.put_array(mesh.triangle_material);
    out.put_array(mesh.triangle_part);
    out.put<std::uint64_t>(mesh.material.size());
    for (const SurfaceMaterial& material : mesh.material) {
        out.put_text(material.name);
        out.put(material.color);
        out.put(material.roughness);
        out.put(material.metallic);
        out.put_text(material.texture.string());
        out.put(material.takes_colors);
        out.put<bool>(material.embedded_texture != nullptr);
        if (material.embedded_texture) out.put(hash_of(*material.embedded_texture));
    }
    out.put<std::uint64_t>(mesh.part_name.size());
    for (const std::string& name : mesh.part_name) out.put_text(name);
}

TriMesh get_mesh(ByteReader& in, const FindImage& find_image) {
    TriMesh mesh;
    mesh.position = in.get_array<Vec3>();
    mesh.triangle = in.get_array<Corners>();
    mesh.position_color = in.get_array<Eigen::Vector3f>();
    mesh.uv = in.get_array<Vec2>();
    mesh.triangle_uv = in.get_array<Corners>();
    mesh.smooth_group_count = in.get<int>();
    mesh.triangle_smooth = in.get_array<Corners>();
    mesh.smooth_normal = in.get_array<Vec3>();
    mesh.triangle_polygon = in.get_array<int>();
    mesh.triangle_material = in.get_array<int>();
    mesh.triangle_part = in.get_array<int>();
    const auto materials = in.get<std::uint64_t>();
    for (std::uint64_t m = 0; m < materials; ++m) {
        SurfaceMaterial material;
        material.name = in.get_text();
        material.color = in.get<Vec3>();
        material.roughness = in.get<double>();
        material.metallic = in.get<double>();
        material.texture = in.get_text();
        material.takes_colors = in.get<bool>();
        if (in.get<bool>()) material.embedded_texture = find_image(in.get<std::uint64_t>());
        mesh.material.push_back(std::move(material));
    }
    const auto parts = in.get<std::uint64_t>();
    for (std::uint64_t p = 0; p < parts; ++p) mesh.part_name.push_back(in.get_text());
    return mesh;
}

}  // namespace swage
