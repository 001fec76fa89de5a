// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/edge_attributes.h"

namespace swage {

namespace {

Vec3 kept_normal(const TriMesh& mesh, int group) {
    const auto g = static_cast<std::size_t>(group);
    return g < mesh.smooth_normal.size() ? mesh.smooth_normal[g] : Vec3(Vec3::Zero());
}

}  // namespace

int add_smooth_group(TriMesh& mesh, const Vec3& normal) {
    if (normal != Vec3::Zero()) {
        mesh.smooth_normal.resize(mesh.smooth_group_count, Vec3::Zero());
        mesh.smooth_normal.push_back(normal);
    }
    return mesh.smooth_group_count++;
}

int EdgeAttributes::uv(int at, int low, int high, double share) {
    if (low < 0 || high < 0) return -1;
    const auto [entry, fresh] =
        uv_.emplace(std::array<int, 3>{at, low, high}, static_cast<int>(mesh_.uv.size()));
    if (fresh) {
        const Vec2 from = mesh_.uv[low], to = mesh_.uv[high];
        mesh_.uv.push_back(from + share * (to - from));
    }
    return entry->second;
}

int EdgeAttributes::smooth(int at, int low, int high, double share) {
    const auto [entry, fresh] =
        smooth_.emplace(std::array<int, 3>{at, low, high}, mesh_.smooth_group_count);
    if (fresh) {
        const Vec3 from = kept_normal(mesh_, low), to = kept_normal(mesh_, high);
        const bool both = from != Vec3::Zero() && to != Vec3::Zero();
        // Not of unit length: so it is linear over a triangle however that is divided.
        add_smooth_group(mesh_, both ? Vec3(from + share * (to - from)) : Vec3(Vec3::Zero()));
    }
    return entry->second;
}

Eigen::Vector3f EdgeAttributes::color(int low, int high, double share) const {
    if (mesh_.position_color.empty()) return Eigen::Vector3f::Ones();
    const Eigen::Vector3f from = mesh_.position_color[low], to = mesh_.position_color[high];
    return from + static_cast<float>(share) * (to - from);
}

int PartedGroups::at(int group, int vertex) {
    const auto g = static_cast<std::size_t>(group);
    if (first_.size() <= g) first_.resize(g + 1, -1);
    if (first_[g] < 0) first_[g] = vertex;
    if (first_[g] == vertex) return group;
    const auto [entry, fresh] =
        own_.emplace(std::array<int, 2>{group, vertex}, mesh_.smooth_group_count);
    if (fresh) add_smooth_group(mesh_, kept_normal(mesh_, group));
    return entry->second;
}

}  // namespace swage
