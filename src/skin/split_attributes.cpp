// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/split_attributes.h"

#include <map>

#include "geometry/edge_attributes.h"
#include "skin/new_look.h"

namespace swage {

namespace {

// Texture coordinates, smoothing and colours of what was divided.
class Carry {
  public:
    Carry(const TriMesh& mesh, const SurfaceSplit& split, const std::vector<double>& share,
          TriMesh& out)
        : mesh_(mesh), split_(split), share_(share), out_(out), made_(out), parted_(out) {}

    void uv() {
        if (mesh_.triangle_uv.empty()) return;
        for (const SplitTriangle& triangle : split_.triangle) {
            Corners uv = {-1, -1, -1};
            for (int k = 0; k < 3 && triangle.parent >= 0; ++k) {
                const Corners& parent = mesh_.triangle_uv[triangle.parent];
                const int raw = triangle.raw[k];
                uv[k] = is_old(raw)
                            ? parent[corner_of(triangle, raw)]
                            : made_.uv(raw, parent[corner_of(triangle, cut(raw).low)],
                                       parent[corner_of(triangle, cut(raw).high)], share(raw));
            }
            out_.triangle_uv.push_back(uv);
        }
    }

    // The two sides of a cut do not share a group.
    void smooth_groups() {
        if (mesh_.triangle_smooth.empty()) return;
        std::map<std::array<int, 2>, int> cap;  // by side and vertex
        for (const SplitTriangle& triangle : split_.triangle) {
            Corners group;
            for (int k = 0; k < 3; ++k) {
                const int vertex = triangle.vertex[k], raw = triangle.raw[k];
                if (triangle.parent < 0) {
                    const auto [at, fresh] =
                        cap.emplace(std::array{triangle.side, vertex}, out_.smooth_group_count);
                    if (fresh) add_smooth_group(out_);
                    group[k] = at->second;
                    continue;
                }
                const Corners& parent = mesh_.triangle_smooth[triangle.parent];
                group[k] =
                    is_old(raw)
                        ? parted_.at(parent[corner_of(triangle, raw)], vertex)
                        : made_.smooth(vertex, parent[corner_of(triangle, cut(raw).low)],
                                       parent[corner_of(triangle, cut(raw).high)], share(raw));
            }
            out_.triangle_smooth.push_back(group);
        }
    }

    void colors() {
        if (mesh_.position_color.empty()) return;
        for (const SplitVertex& vertex : split_.added) {
            Eigen::Vector3f color = Eigen::Vector3f::Ones();
            if (is_old(vertex.raw)) {
                color = mesh_.position_color[vertex.raw];
            } else if (vertex.raw - old_ < static_cast<int>(split_.cut.size())) {
                color = made_.color(cut(vertex.raw).low, cut(vertex.raw).high, share(vertex.raw));
            }
            out_.position_color.push_back(color);
        }
    }

  private:
    bool is_old(int raw) const { return raw < old_; }
    const CutPoint& cut(int raw) const { return split_.cut[raw - old_]; }
    double share(int raw) const { return share_[raw - old_]; }
    int corner_of(const SplitTriangle& triangle, int v) const {
        const Corners& parent = mesh_.triangle[triangle.parent];
        return parent[0] == v ? 0 : parent[1] == v ? 1 : 2;
    }

    const TriMesh& mesh_;
    const SurfaceSplit& split_;
    const std::vector<double>& share_;
    TriMesh& out_;
    EdgeAttributes made_;
    PartedGroups parted_;
    const int old_ = static_cast<int>(mesh_.position.size());
};

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
    out.smooth_group_count = mesh.smooth_group_count;
    out.smooth_normal = mesh.smooth_normal;
    out.material = mesh.material;
    out.part_name = mesh.part_name;
    for (const SplitTriangle& triangle : split.triangle) {
        out.triangle.push_back(triangle.vertex);
        if (mesh.triangle_part.empty()) continue;
        const int source = triangle.parent >= 0 ? triangle.parent : triangle.neighbor;
        out.triangle_part.push_back(source >= 0 ? mesh.triangle_part[source] : 0);
    }
    Carry carry(mesh, split, share, out);
    carry.uv();
    carry.smooth_groups();
    carry.colors();
    carry_polygons(mesh, split, out);
    carry_materials(mesh, split, out);
    return out;
}

}  // namespace swage
