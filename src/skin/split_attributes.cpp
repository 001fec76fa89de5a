// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/split_attributes.h"

#include <algorithm>
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
                uv[k] = uv_at(triangle, triangle.raw[k]);
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
                const auto of = [&](int old) {
                    return mesh_.triangle_smooth[triangle.parent][corner_of(triangle, old)];
                };
                if (is_old(raw)) {
                    group[k] = parted_.at(of(raw), vertex);
                    continue;
                }
                const auto [low, high, share] = between(raw);
                group[k] = is_old(low) && is_old(high)
                               ? made_.smooth(vertex, of(low), of(high), share)
                               : rim_group(triangle, raw, vertex);
            }
            out_.triangle_smooth.push_back(group);
        }
    }

    void colors() {
        if (mesh_.position_color.empty()) return;
        for (const SplitVertex& vertex : split_.added) {
            out_.position_color.push_back(color_at(vertex.raw));
        }
    }

  private:
    bool is_old(int raw) const { return raw < old_; }
    // A cut point or one on the rim.
    RimPoint between(int raw) const {
        const int at = raw - old_;
        if (at >= static_cast<int>(split_.cut.size())) return split_.rim.at(raw);
        return {split_.cut[at].low, split_.cut[at].high, share_[at]};
    }
    int uv_at(const SplitTriangle& triangle, int raw) {
        if (is_old(raw)) return mesh_.triangle_uv[triangle.parent][corner_of(triangle, raw)];
        const auto [low, high, share] = between(raw);
        return made_.uv(raw, uv_at(triangle, low), uv_at(triangle, high), share);
    }
    Eigen::Vector3f color_at(int raw) const {
        if (is_old(raw)) return mesh_.position_color[raw];
        const bool is_inner =
            raw - old_ >= static_cast<int>(split_.cut.size()) && !split_.rim.contains(raw);
        if (is_inner) return Eigen::Vector3f::Ones();
        const auto [low, high, share] = between(raw);
        const Eigen::Vector3f from = color_at(low), to = color_at(high);
        return from + static_cast<float>(share) * (to - from);
    }
    Vec3 normal_at(const SplitTriangle& triangle, int raw) const {
        if (is_old(raw)) {
            const auto group = static_cast<std::size_t>(
                mesh_.triangle_smooth[triangle.parent][corner_of(triangle, raw)]);
            return group < mesh_.smooth_normal.size() ? mesh_.smooth_normal[group]
                                                      : Vec3(Vec3::Zero());
        }
        const auto [low, high, share] = between(raw);
        const Vec3 from = normal_at(triangle, low), to = normal_at(triangle, high);
        const bool both = from != Vec3::Zero() && to != Vec3::Zero();
        return both ? Vec3(from + share * (to - from)) : Vec3(Vec3::Zero());
    }
    // Of a point within a triangle, which shares it with nothing else on its side.
    int rim_group(const SplitTriangle& triangle, int raw, int vertex) {
        const auto [at, fresh] = rim_group_.emplace(vertex, out_.smooth_group_count);
        if (fresh) add_smooth_group(out_, normal_at(triangle, raw));
        return at->second;
    }
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
    std::map<int, int> rim_group_;  // by vertex
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

void carry_materials(const TriMesh& mesh, const SurfaceSplit& split, const Insides& insides,
                     TriMesh& out) {
    const bool has_cap = !split.triangle.empty() && split.triangle.back().parent < 0;
    if (!has_cap && mesh.triangle_material.empty()) return;
    if (out.material.empty()) out.material.emplace_back();
    // A material that no face has would be an empty slot in files.
    const bool is_shown = std::ranges::any_of(split.triangle, [](const SplitTriangle& triangle) {
        return triangle.parent < 0 && triangle.inside < 0;
    });
    const int cut = is_shown ? cut_material(out, mesh) : -1;
    for (const SplitTriangle& triangle : split.triangle) {
        int material = cut;
        if (triangle.inside >= 0) {
            material = inside_material(out, insides.look(triangle.inside));
        } else if (triangle.parent >= 0) {
            material = mesh.triangle_material.empty() ? 0 : mesh.triangle_material[triangle.parent];
        }
        out.triangle_material.push_back(material);
    }
}

}  // namespace

TriMesh apply_split(const TriMesh& mesh, const SurfaceSplit& split,
                    const std::vector<Vec3>& reference, const std::vector<double>& share,
                    const Insides& insides) {
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
    carry_materials(mesh, split, insides, out);
    return out;
}

}  // namespace swage
