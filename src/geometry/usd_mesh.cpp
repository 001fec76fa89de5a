// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/usd_mesh.h"

#include "geometry/box.h"
#include "geometry/edges.h"

namespace swage {

CornerValues::CornerValues(const std::vector<Corners>& ids, std::size_t count,
                           const PolygonCorners& polygons)
    : index(polygons.corner.size(), -1) {
    std::vector<int> number(count, -1);
    for (std::size_t i = 0; i < index.size() && !ids.empty(); ++i) {
        const int id = ids[polygons.corner[i] / 3][polygons.corner[i] % 3];
        if (id < 0) continue;
        if (number.at(id) < 0) {
            number[id] = static_cast<int>(used.size());
            used.push_back(id);
        }
        index[i] = number[id];
    }
}

CornerValues corner_normals(const TriMesh& mesh, const PolygonCorners& polygons) {
    return {mesh.triangle_smooth, std::size_t(mesh.smooth_group_count), polygons};
}

void write_usd_normals(UsdText& out, const TriMesh& mesh, const std::vector<Vec3>& position,
                       const CornerValues& values) {
    std::vector<Vec3> normal;
    if (!mesh.triangle.empty()) normal = smooth_normals(mesh, position);
    out.list(values.used.size(), [&](std::size_t i) {
        const Vec3 n = normal[values.used[i]] * 1e5;  // to as much as they tell
        out.vector<3>(Vec3(n.array().round() / 1e5).cast<float>());
    });
}

void write_usd_surface(UsdText& out, const TriMesh& mesh, const Vec3& color) {
    const std::vector<int> always = {0};
    const PolygonCorners polygons = rejoin_polygons(mesh);
    const Box box = box_of(mesh.position);
    const auto place = [&](const Vec3& p) { out.vector<3>(p.cast<float>()); };
    if (!is_closed(mesh)) out.line("uniform bool doubleSided = 1");
    out.value("float3[] extent", "", always,
              [&](int) { out.list(2, [&](std::size_t end) { place(end ? box.high : box.low); }); });
    out.value("int[] faceVertexCounts", "", always, [&](int) {
        out.list(polygons.count(), [&](std::size_t p) {
            out.number(static_cast<int>(polygons.first[p + 1] - polygons.first[p]));
        });
    });
    out.value("int[] faceVertexIndices", "", always, [&](int) {
        out.list(polygons.corner.size(), [&](std::size_t i) {
            const int corner = polygons.corner[i];
            out.number(mesh.triangle[corner / 3][corner % 3]);
        });
    });
    out.line("uniform token orientation = \"rightHanded\"");
    out.value("point3f[] points", "", always, [&](int) {
        out.list(mesh.position.size(), [&](std::size_t i) { place(mesh.position[i]); });
    });
    out.value("color3f[] primvars:displayColor", "constant", always,
              [&](int) { out.list(1, [&](std::size_t) { place(color); }); });
    if (mesh.triangle_smooth.size() == mesh.triangle.size()) {
        const CornerValues values = corner_normals(mesh, polygons);
        out.value("normal3f[] primvars:normals", kUsdOfCorners, always,
                  [&](int) { write_usd_normals(out, mesh, mesh.position, values); });
        out.value("int[] primvars:normals:indices", "", always, [&](int) {
            out.list(values.index.size(), [&](std::size_t i) { out.number(values.index[i]); });
        });
    }
    out.line("uniform token subdivisionScheme = \"none\"");
}

}  // namespace swage
