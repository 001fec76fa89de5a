// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/split_attributes.h"

#include <map>
#include <tuple>

#include "skin/new_look.h"

namespace swage {

namespace {

// Hands out values for corners that lie on an edge between two corners of the parent.
class CornerValues {
  public:
    CornerValues(const TriMesh& mesh, const SurfaceSplit& split) : mesh_(mesh), split_(split) {}

    // f(corner) for a corner of the parent, between(cut, value at low, value at high) on an edge.
    template <typename Value, typename Between>
    int at(const SplitTriangle& triangle, int k, const Value& value, const Between& between) const {
        const Corners& parent = mesh_.triangle[triangle.parent];
        const int raw = triangle.raw[k], old = static_cast<int>(mesh_.position.size());
        const auto corner_of = [&](int v) { return parent[0] == v ? 0 : parent[1] == v ? 1 : 2; };
        if (raw < old) return value(corner_of(raw));
        const CutPoint& cut = split_.cut[raw - old];
        return between(raw - old, value(corner_of(cut.low)), value(corner_of(cut.high)));
    }

  private:
    const TriMesh& mesh_;
    const SurfaceSplit& split_;
};

void carry_uv(const TriMesh& mesh, const SurfaceSplit& split, const std::vector<double>& share,
              TriMesh& out) {
    if (mesh.triangle_uv.empty()) return;
    const CornerValues values(mesh, split);
    std::map<std::tuple<int, int, int>, int> made;  // cut point and its ends' values
    for (const SplitTriangle& triangle : split.triangle) {
        Corners uv = {-1, -1, -1};
        for (int k = 0; k < 3 && triangle.parent >= 0; ++k) {
            const Corners& parent = mesh.triangle_uv[triangle.parent];
            uv[k] = values.at(
                triangle, k, [&](int c) { return parent[c]; },
                [&](int cut, int low, int high) {
                    if (low < 0 || high < 0) return -1;
                    const auto [at, fresh] =
                        made.emplace(std::tuple(cut, low, high), static_cast<int>(out.uv.size()));
                    if (fresh) {
                        const Vec2 from = mesh.uv[low], to = mesh.uv[high];
                        out.uv.push_back(from + share[cut] * (to - from));
                    }
                    return at->second;
                });
        }
        out.triangle_uv.push_back(uv);
    }
}

void carry_smooth_groups(const TriMesh& mesh, const SurfaceSplit& split, TriMesh& out) {
    if (mesh.triangle_smooth.empty()) return;
    const CornerValues values(mesh, split);
    // A group is told by where it comes from and by the vertex: the two sides do not share one.
    std::map<std::tuple<int, int, int>, int> made;
    std::map<std::pair<int, int>, int> group_vertex;
    std::vector<int> first_vertex(mesh.smooth_group_count, -1);
    out.smooth_group_count = mesh.smooth_group_count;
    const auto fresh_group = [&](const auto& key) {
        const auto [at, fresh] = made.emplace(key, out.smooth_group_count);
        out.smooth_group_count += fresh;
        return at->second;
    };
    for (const SplitTriangle& triangle : split.triangle) {
        Corners group;
        for (int k = 0; k < 3; ++k) {
            const int vertex = triangle.vertex[k];
            if (triangle.parent < 0) {
                group[k] = fresh_group(std::tuple(-1, triangle.side, vertex));
                continue;
            }
            const Corners& parent = mesh.triangle_smooth[triangle.parent];
            group[k] = values.at(
                triangle, k, [&](int c) { return parent[c]; },
                [&](int cut, int low, int high) {
                    return -1 - fresh_group(std::tuple(cut, low, high));  // not known before
                });
            if (group[k] >= 0 && first_vertex[group[k]] < 0) first_vertex[group[k]] = vertex;
            if (group[k] < 0 || first_vertex[group[k]] != vertex) {
                const auto [at, fresh] =
                    group_vertex.emplace(std::pair(group[k], vertex), out.smooth_group_count);
                out.smooth_group_count += fresh;
                group[k] = at->second;
            }
        }
        out.triangle_smooth.push_back(group);
    }
}

void carry_colors(const TriMesh& mesh, const SurfaceSplit& split, const std::vector<double>& share,
                  TriMesh& out) {
    if (mesh.position_color.empty()) return;
    const int old = static_cast<int>(mesh.position.size());
    for (const SplitVertex& vertex : split.added) {
        Eigen::Vector3f color = Eigen::Vector3f::Ones();
        if (vertex.raw < old) {
            color = mesh.position_color[vertex.raw];
        } else if (vertex.raw - old < static_cast<int>(split.cut.size())) {
            const CutPoint& cut = split.cut[vertex.raw - old];
            const Eigen::Vector3f low = mesh.position_color[cut.low];
            const Eigen::Vector3f high = mesh.position_color[cut.high];
            color = low + static_cast<float>(share[vertex.raw - old]) * (high - low);
        }
        out.position_color.push_back(color);
    }
}

void carry_polygons(const TriMesh& mesh, const SurfaceSplit& split, TriMesh& out) {
    if (mesh.triangle_polygon.empty()) return;
    int number = -1, last = -1;
    bool open = false;  // the last triangle's polygon may go on
    for (const SplitTriangle& triangle : split.triangle) {
        const bool whole = triangle.parent >= 0 && !triangle.split;
        const int own = whole ? mesh.triangle_polygon[triangle.parent] : -1;
        if (!(whole && open && own == last)) ++number;
        open = whole;
        last = own;
        out.triangle_polygon.push_back(number);
    }
}

void carry_materials(const TriMesh& mesh, const SurfaceSplit& split, TriMesh& out) {
    const bool has_cap = !split.triangle.empty() && split.triangle.back().parent < 0;
    if (!has_cap && mesh.triangle_material.empty()) return;
    const int cut = has_cap ? cut_material(out, mesh) : -1;
    for (const SplitTriangle& triangle : split.triangle) {
        int material = cut;
        if (triangle.parent >= 0) {
            material = mesh.triangle_material.empty() ? 0 : mesh.triangle_material[triangle.parent];
        }
        out.triangle_material.push_back(material);
    }
}

}  // namespace

TriMesh apply_split(const TriMesh& mesh, const SurfaceSplit& split,
                    const std::vector<Vec3>& reference, const std::vector<double>& share) {
    TriMesh out;
    out.position = mesh.position;
    out.position.insert(out.position.end(), reference.begin(), reference.end());
    out.position_color = mesh.position_color;
    out.uv = mesh.uv;
    out.material = mesh.material;
    out.part_name = mesh.part_name;
    for (const SplitTriangle& triangle : split.triangle) {
        out.triangle.push_back(triangle.vertex);
        if (mesh.triangle_part.empty()) continue;
        const int source = triangle.parent >= 0 ? triangle.parent : triangle.neighbor;
        out.triangle_part.push_back(source >= 0 ? mesh.triangle_part[source] : 0);
    }
    carry_uv(mesh, split, share, out);
    carry_smooth_groups(mesh, split, out);
    carry_colors(mesh, split, share, out);
    carry_polygons(mesh, split, out);
    carry_materials(mesh, split, out);
    return out;
}

}  // namespace swage
