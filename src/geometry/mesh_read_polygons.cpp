// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/error.h"
#include "geometry/mesh_read_child.h"
#include "geometry/polygon.h"

namespace swage {

void add_polygons(const PolygonList& polygons, RawMesh& mesh) {
    const auto where = [&](std::size_t p) {
        return polygons.line[p] > 0 ? fmt::format("line {}", polygons.line[p])
                                    : fmt::format("face {}", p);
    };
    const auto check = [&](std::size_t p, int index, std::size_t count, const char* what) {
        if (index >= static_cast<long long>(count))
            fail(ExitCode::mesh, "{}: {} {} is used, but there are only {}", where(p), what,
                 static_cast<long long>(index) + 1, count);
    };
    const auto any = [](const std::vector<int>& ids) {
        return std::any_of(ids.begin(), ids.end(), [](int i) { return i >= 0; });
    };
    const bool has_uv = any(polygons.uv), has_normal = any(polygons.normal);
    const bool has_material = any(polygons.material), has_part = any(polygons.part);
    const bool has_smooth = !polygons.smooth.empty();
    std::size_t thin = 0, crossed = 0;
    std::vector<int> corner;
    std::vector<Vec3> place;
    std::vector<Corners> cut;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        corner.clear();
        place.clear();
        cut.clear();
        for (int c = polygons.first[p]; c < polygons.first[p + 1]; ++c) {
            check(p, polygons.position[c], mesh.position.size(), "vertex");
            check(p, polygons.uv[c], mesh.uv.size(), "texture coordinate");
            check(p, polygons.normal[c], mesh.normal.size(), "normal");
            if (!corner.empty() && polygons.position[corner.back()] == polygons.position[c])
                continue;
            corner.push_back(c);
        }
        while (corner.size() > 1 &&
               polygons.position[corner.front()] == polygons.position[corner.back()])
            corner.pop_back();
        if (corner.size() < 3) {
            ++thin;
            continue;
        }
        for (const int c : corner) place.push_back(mesh.position[polygons.position[c]]);
        if (!cut_polygon(place, cut)) ++crossed;
        for (const Corners& t : cut) {
            const auto pick = [&](const std::vector<int>& ids) {
                return Corners{ids[corner[t[0]]], ids[corner[t[1]]], ids[corner[t[2]]]};
            };
            mesh.triangle.push_back(pick(polygons.position));
            if (has_uv) mesh.triangle_uv.push_back(pick(polygons.uv));
            if (has_normal) mesh.triangle_normal.push_back(pick(polygons.normal));
            mesh.polygon.push_back(static_cast<int>(p));
            if (has_material) mesh.triangle_material.push_back(polygons.material[p]);
            if (has_part) mesh.triangle_part.push_back(polygons.part[p]);
            if (has_smooth) mesh.triangle_smooth.push_back(polygons.smooth[p]);
        }
    }
    if (thin > 0)
        mesh.finding.push_back(
            fmt::format("{} faces of fewer than three different corners were left out", thin));
    if (crossed > 0)
        mesh.finding.push_back(fmt::format(
            "{} polygons cross themselves; they were triangulated as well as possible", crossed));
}

}  // namespace swage
