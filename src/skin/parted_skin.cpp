// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/parted_skin.h"

#include <algorithm>

#include "geometry/edges.h"

namespace swage {

namespace {

std::uint64_t key_of(const Vec3i& site, int axis) {
    const auto part = [](int i) { return static_cast<std::uint64_t>(i + (1 << 19)) & 0xFFFFF; };
    return part(site.x()) | part(site.y()) << 20 | part(site.z()) << 40 |
           static_cast<std::uint64_t>(axis) << 60;
}

}  // namespace

std::vector<BrokenFace> broken_faces(const Aggregate& matter) {
    std::vector<BrokenFace> faces;
    if (matter.connection[0].damage.empty()) return faces;
    for (const ParticleRun& run : matter.lattice.particle_run) {
        for (int n = 0; n < run.count; ++n) {
            for (int axis = 0; axis < kEdgeCount; ++axis) {
                const ConnectionArrays& all = matter.connection[axis];
                const ParticleId lower = run.first + n;
                if (all.damage[lower] >= 1 && all.weight[lower] <= 0) {
                    faces.push_back({{run.i + n, run.j, run.k}, axis});
                }
            }
        }
    }
    return faces;
}

PartedSkin::PartedSkin(const TriMesh& whole, const Mount& whole_mount, const Aggregate& matter,
                       const std::vector<BrokenFace>& faces)
    : matter_(matter) {
    std::unordered_set<std::uint64_t> beside;  // cubes at broken faces
    for (const BrokenFace& face : faces) {
        broken_.insert(key_of(face.site, face.axis));
        Vec3i upper = face.site;
        ++upper[face.axis];
        beside.insert({key_of(face.site, 0), key_of(upper, 0)});
    }
    diced_ = dice_skin(whole, matter.lattice,
                       [&](const Vec3i& site) { return beside.contains(key_of(site, 0)); });
    mesh = diced_.mesh;
    plane_ = diced_.plane;
    site_ = diced_.site;
    mount.kind = whole_mount.kind;
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
        const bool old = v < whole_mount.reference.size();
        mount.reference.push_back(mesh.position[v]);
        mount.cell.push_back(old ? whole_mount.cell[v] : carrying_cell(matter, mesh.position[v]));
        mount.side.push_back(old ? whole_mount.side[v] : kAllCorners);
        source_.push_back(static_cast<int>(v));
    }
    part_vertices();
}

bool PartedSkin::joined(const Vec3i& lower, int axis) const {
    return !broken_.contains(key_of(lower, axis));
}

// The cubes around the vertex that hang together there with the one at `site`.
PartedSkin::Mask PartedSkin::group_of(int v, const Vec3i& site) const {
    const std::array<int, 3>& plane = plane_[v];
    Vec3i low = site;
    int way = 0, own = 0;
    for (int d = 0; d < 3; ++d) {
        if (plane[d] == kNoPlane) continue;
        low[d] = plane[d];
        way |= 1 << d;
        own |= (site[d] > plane[d]) << d;
    }
    Mask group = static_cast<Mask>(1 << own), before = 0;
    while (group != before) {
        before = group;
        for (int c = 0; c < 8; ++c) {
            if (!(group >> c & 1)) continue;
            for (int d = 0; d < 3; ++d) {
                if (!(way >> d & 1)) continue;
                Vec3i at = low + Vec3i(c & 1, c >> 1 & 1, c >> 2);
                at[d] = low[d];
                if (joined(at, d)) group |= static_cast<Mask>(1 << (c ^ 1 << d));
            }
        }
    }
    return group;
}

PartedSkin::Mask PartedSkin::all_around(const std::array<int, 3>& plane) {
    Mask all = 0;
    for (int c = 0; c < 8; ++c) {
        bool is = true;
        for (int d = 0; d < 3; ++d) is = is && (plane[d] != kNoPlane || !(c >> d & 1));
        all |= static_cast<Mask>(is << c);
    }
    return all;
}

int PartedSkin::copy_of(int v, const Vec3i& site) {
    const Mask group = group_of(v, site);
    if (group == all_around(plane_[v])) {
        if (!used_[v]) take_sides(v, v, site, group);
        used_[v] = 1;
        return v;
    }
    const auto known = taken_.find({v, group});
    if (known != taken_.end()) return known->second;
    int copy = v;
    if (used_[v]) {
        copy = static_cast<int>(mesh.position.size());
        mesh.position.push_back(mesh.position[v]);
        if (!mesh.position_color.empty()) {
            const Eigen::Vector3f color = mesh.position_color[v];
            mesh.position_color.push_back(color);
        }
        mount.reference.push_back(mesh.position[v]);
        mount.cell.push_back(mount.cell[v]);
        mount.side.push_back(whole_side_[v]);
        source_.push_back(v);
    }
    used_[v] = 1;
    take_sides(copy, v, site, group);
    taken_[{v, group}] = copy;
    return copy;
}

// It follows the corners of its cell that hang together with its group.
void PartedSkin::take_sides(int copy, int v, const Vec3i& site, Mask group) {
    const Vec3i cell = matter_.lattice.cell_site(mount.cell[copy]);
    Vec3i low = site;
    for (int d = 0; d < 3; ++d) {
        if (plane_[v][d] != kNoPlane) low[d] = plane_[v][d];
    }
    int side = 0;
    for (int c = 0; c < 8; ++c) {
        if (!(group >> c & 1)) continue;
        const Vec3i at = low + Vec3i(c & 1, c >> 1 & 1, c >> 2) - cell;
        if ((at.array() < 0).any() || (at.array() > 1).any()) continue;
        side |= 1 << (at.x() + 2 * at.y() + 4 * at.z());
    }
    for (int before = 0; side != before;) {
        before = side;
        for (int c = 0; c < 8; ++c) {
            for (int d = 0; d < 3 && side >> c & 1; ++d) {
                Vec3i at = cell + Vec3i(c & 1, c >> 1 & 1, c >> 2);
                at[d] = cell[d];
                if (joined(at, d)) side |= 1 << (c ^ 1 << d);
            }
        }
    }
    if (side & whole_side_[v]) mount.side[copy] = static_cast<CornerMask>(side & whole_side_[v]);
}

void PartedSkin::part_vertices() {
    used_.assign(plane_.size(), 0);
    whole_side_ = mount.side;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        for (int& v : mesh.triangle[t]) v = copy_of(v, site_[t]);
    }
    // Corners that shared a shading normal no longer do where their vertices parted.
    std::map<std::pair<int, int>, int> group;  // old group and vertex
    std::vector<int> first(mesh.smooth_group_count, -1);
    for (std::size_t t = 0; t < mesh.triangle_smooth.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            int& own = mesh.triangle_smooth[t][k];
            const int v = mesh.triangle[t][k];
            if (first[own] < 0) first[own] = v;
            if (first[own] == v) continue;
            const auto [at, fresh] = group.emplace(std::pair(own, v), mesh.smooth_group_count);
            mesh.smooth_group_count += fresh;
            own = at->second;
        }
    }
}

int PartedSkin::add_vertex(const Vec3& place, const std::array<int, 3>& plane,
                           const Eigen::Vector3f& color) {
    const std::size_t v = mesh.position.size();
    mesh.position.push_back(place);
    if (!mesh.position_color.empty()) mesh.position_color.push_back(color);
    mount.reference.push_back(place);
    mount.cell.push_back(carrying_cell(matter_, place));
    mount.side.push_back(kAllCorners);
    source_.push_back(static_cast<int>(v));
    plane_.resize(v + 1, {kNoPlane, kNoPlane, kNoPlane});
    plane_[v] = plane;
    used_.resize(v + 1, 0);
    whole_side_.resize(v + 1, kAllCorners);
    return static_cast<int>(v);
}

void PartedSkin::part_touching_edges() {
    std::map<Segment, int> middle;  // of edges that touch, low number first
    bool any = false;
    bool again = true;
    for (int round = 0; again; ++round) {
        for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
            if (uses.size() <= 2 || round > 1) return;
            const auto plane = common_planes(uses[0].low, uses[0].high);
            const bool between = all_around(plane) != 1;  // cubes, so not the mesh's own doing
            if (between) middle.emplace(Segment{uses[0].low, uses[0].high}, -1);
        });
        again = false;
        const std::size_t count = mesh.triangle.size();
        for (std::size_t t = 0; t < count && !middle.empty(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] =
                    std::minmax(mesh.triangle[t][k], mesh.triangle[t][(k + 1) % 3]);
                const auto at = middle.find({low, high});
                if (at == middle.end()) continue;
                if (at->second < 0) at->second = half_way(low, high);
                bisect(t, k, at->second);
                any = again = true;
                break;
            }
        }
    }
    for (std::size_t t = 0; any && t < mesh.triangle_polygon.size(); ++t) {
        mesh.triangle_polygon[t] = static_cast<int>(t);
    }
}

std::array<int, 3> PartedSkin::common_planes(int v, int w) const {
    std::array<int, 3> plane = plane_[source_[v]];
    for (int d = 0; d < 3; ++d) {
        if (plane_[source_[w]][d] != plane[d]) plane[d] = kNoPlane;
    }
    return plane;
}

int PartedSkin::half_way(int low, int high) {
    Eigen::Vector3f color = Eigen::Vector3f::Ones();
    if (!mesh.position_color.empty()) {
        color = 0.5f * (mesh.position_color[low] + mesh.position_color[high]);
    }
    return add_vertex(0.5 * (mesh.position[low] + mesh.position[high]), common_planes(low, high),
                      color);
}

void PartedSkin::bisect(std::size_t t, int k, int middle) {
    const Vec3i site = site_[t];
    const int v = copy_of(middle, site), next = (k + 1) % 3;
    const auto again = [&](auto& values) {
        if (!values.empty()) {
            const auto value = values[t];
            values.push_back(value);
        }
    };
    again(mesh.triangle);
    again(mesh.triangle_uv);
    again(mesh.triangle_smooth);
    again(mesh.triangle_material);
    again(mesh.triangle_part);
    again(mesh.triangle_polygon);
    site_.push_back(site);
    mesh.triangle[t][next] = mesh.triangle.back()[k] = v;
    if (!mesh.triangle_uv.empty() && mesh.triangle_uv[t][k] >= 0) {
        const Vec2 uv =
            0.5 * (mesh.uv[mesh.triangle_uv[t][k]] + mesh.uv[mesh.triangle_uv[t][next]]);
        mesh.triangle_uv[t][next] = mesh.triangle_uv.back()[k] = static_cast<int>(mesh.uv.size());
        mesh.uv.push_back(uv);
    }
    if (mesh.triangle_smooth.empty()) return;
    const auto [low, high] = std::minmax(mesh.triangle_smooth[t][k], mesh.triangle_smooth[t][next]);
    const auto [at, fresh] =
        half_smooth_.emplace(std::array<int, 3>{v, low, high}, mesh.smooth_group_count);
    mesh.smooth_group_count += fresh;
    mesh.triangle_smooth[t][next] = mesh.triangle_smooth.back()[k] = at->second;
}

}  // namespace swage
