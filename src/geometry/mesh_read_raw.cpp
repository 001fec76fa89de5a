// SPDX-License-Identifier: GPL-3.0-or-later
// The plain arrays that cross the pipe between the reading process and its parent.
#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/error.h"
#include "geometry/mesh_read_child.h"

namespace swage {

namespace {

constexpr std::uint64_t kMagic = 0x3168'7365'6d77'7301;
constexpr double kLargest = 1e9;    // [m], coordinates
constexpr double kSmallest = 1e-9;  // [m], the box's diagonal

void check_indices(const std::vector<Corners>& corners, std::size_t count, int least,
                   const char* what) {
    for (const Corners& c : corners)
        for (const int i : c)
            if (i < least || i >= static_cast<long long>(count))
                fail(ExitCode::mesh, "{} {} of {} does not exist", what, i, count);
}

void check_ids(const std::vector<int>& ids, std::size_t triangles, std::size_t count,
               const char* what) {
    if (ids.empty()) return;
    if (ids.size() != triangles) fail(ExitCode::mesh, "one {} a triangle was expected", what);
    for (const int i : ids)
        if (i < 0 || i >= static_cast<long long>(count))
            fail(ExitCode::mesh, "{} {} of {} does not exist", what, i, count);
}

}  // namespace

template <typename Io>
void visit(Io& io, RawMaterial& material) {
    auto& [name, color, roughness, metallic, texture, texture_bytes] = material;
    io(name, color, roughness, metallic, texture, texture_bytes);
}

template <typename Io>
void visit(Io& io, RawMesh& mesh) {
    auto& [position, color, uv, normal, triangle, triangle_uv, triangle_normal, polygon,
           triangle_material, triangle_part, triangle_smooth, material, part_name, finding,
           at_vertices] = mesh;
    io(position, color, uv, normal, triangle, triangle_uv, triangle_normal, polygon,
       triangle_material, triangle_part, triangle_smooth, material, part_name, finding,
       at_vertices);
}

std::string to_bytes(const RawMesh& mesh) {
    ByteWriter writer;
    writer(kMagic, mesh);
    return writer.bytes();
}

RawMesh from_bytes(std::string_view bytes) {
    ByteReader reader(bytes);
    RawMesh mesh;
    try {
        if (reader.get<std::uint64_t>() != kMagic)
            fail(ExitCode::mesh, "the reading process sent no mesh");
        reader(mesh);
    } catch (const Error& error) {
        if (error.code() == ExitCode::mesh) throw;
        fail(ExitCode::mesh, "the reading process sent an incomplete mesh");
    }
    return mesh;
}

void check_raw(const RawMesh& mesh) {
    const std::size_t count = mesh.triangle.size();
    if (count == 0) fail(ExitCode::mesh, "no triangles");
    constexpr std::size_t kMost = 0x7fffffff / 3;  // ids of corners are ints
    if (count > kMost || mesh.position.size() > kMost)
        fail(ExitCode::mesh, "{} vertices and {} triangles are more than can be handled",
             mesh.position.size(), count);
    check_indices(mesh.triangle, mesh.position.size(), 0, "vertex");
    check_indices(mesh.triangle_uv, mesh.uv.size(), -1, "texture coordinate");
    check_indices(mesh.triangle_normal, mesh.normal.size(), -1, "normal");
    for (const std::size_t n : {mesh.triangle_uv.size(), mesh.triangle_normal.size()})
        if (n != 0 && n != count) fail(ExitCode::mesh, "attributes do not fit the triangles");
    if (!mesh.color.empty() && mesh.color.size() != mesh.position.size())
        fail(ExitCode::mesh, "vertex colours do not fit the vertices");
    if (!mesh.triangle_smooth.empty() && mesh.triangle_smooth.size() != count)
        fail(ExitCode::mesh, "smoothing does not fit the triangles");
    if (mesh.polygon.size() != count) fail(ExitCode::mesh, "polygons do not fit the triangles");
    check_ids(mesh.triangle_material, count, mesh.material.size(), "material");
    check_ids(mesh.triangle_part, count, mesh.part_name.size(), "part");

    Box box;  // of what is used: a stray vertex does no harm
    for (const Corners& t : mesh.triangle)
        for (const int i : t) {
            const Vec3& p = mesh.position[i];
            if (!p.allFinite())
                fail(ExitCode::mesh, "vertex {} has coordinates that are not finite", i);
            box.grow(p);
        }
    const double largest = std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff());
    if (largest > kLargest)
        fail(ExitCode::mesh, "a coordinate of {:g} m is unreasonably large", largest);
    if (box.size().norm() < kSmallest)
        fail(ExitCode::mesh, "the whole mesh is only {:g} m in size", box.size().norm());
    // Of normals only those that are numbers count.
    for (const Vec2& t : mesh.uv)
        if (!t.allFinite()) fail(ExitCode::mesh, "a texture coordinate is not finite");
    for (const auto& c : mesh.color)
        if (!c.allFinite()) fail(ExitCode::mesh, "a vertex colour is not finite");
    for (const auto& m : mesh.material)
        if (!m.color.allFinite() || !std::isfinite(m.roughness) || !std::isfinite(m.metallic))
            fail(ExitCode::mesh, "the material '{}' has values that are not finite", m.name);
}

}  // namespace swage
