// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/new_look.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "base/parallel.h"
#include "geometry/disjoint_sets.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 512;  // triangles
// What a corner of a face may be off the face's middle in the texture, over what the middle's
// triangle makes of the way there: more is another part of the mesh.
constexpr double kStretch = 3;
constexpr double kPaler = 0.35;
const Vec3 kPale(0.86, 0.82, 0.76);

double area_of(const TriMesh& mesh, std::size_t triangle) {
    const auto& [a, b, c] = mesh.triangle[triangle];
    const Vec3 &p = mesh.position[a], &q = mesh.position[b], &r = mesh.position[c];
    return 0.5 * (q - p).cross(r - p).norm();
}

// The material that most of the surface has.
SurfaceMaterial main_look(const TriMesh& mesh) {
    if (mesh.material.empty()) return {};
    std::vector<double> area(mesh.material.size(), 0.0);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        area[mesh.triangle_material.empty() ? 0 : mesh.triangle_material[t]] += area_of(mesh, t);
    }
    return mesh.material[std::max_element(area.begin(), area.end()) - area.begin()];
}

// Across which edges of each triangle the texture goes on.
std::vector<Corners> adjoining(const TriMesh& mesh) {
    using Corner = std::tuple<int, double, double>;  // position, and place in the texture
    std::map<std::pair<Corner, Corner>, std::pair<int, int>> open;  // to triangle and edge
    std::vector<Corners> adjoins(mesh.triangle.size(), Corners{-1, -1, -1});
    for (std::size_t t = 0; t < mesh.triangle_uv.size(); ++t) {
        const auto corner = [&](int c) {
            const Vec2& uv = mesh.uv[mesh.triangle_uv[t][c]];
            return Corner(mesh.triangle[t][c], uv.x(), uv.y());
        };
        const Corners& uv = mesh.triangle_uv[t];
        if (uv[0] < 0 || uv[1] < 0 || uv[2] < 0) continue;
        for (int c = 0; c < 3; ++c) {
            const std::pair edge(corner(c), corner((c + 1) % 3));
            const auto met = open.find({edge.second, edge.first});
            if (met == open.end()) {
                open.emplace(edge, std::pair(static_cast<int>(t), c));
                continue;
            }
            adjoins[t][c] = met->second.first;
            adjoins[met->second.first][met->second.second] = static_cast<int>(t);
            open.erase(met);
        }
    }
    return adjoins;
}

std::vector<int> charts_of(const std::vector<Corners>& adjoins) {
    DisjointSets sets(adjoins.size());
    for (std::size_t t = 0; t < adjoins.size(); ++t) {
        for (int other : adjoins[t]) {
            if (other >= 0) sets.unite(other, static_cast<int>(t));
        }
    }
    std::vector<int> chart;
    sets.number_sets(chart);
    return chart;
}

}  // namespace

SurfaceMaterial cut_look(const TriMesh& mesh) {
    const SurfaceMaterial outside = main_look(mesh);
    SurfaceMaterial look;
    look.name = kCutMaterial;
    look.takes_colors = false;  // those of its rim are the outside's
    const bool hides = !outside.texture.empty() || outside.embedded_texture != nullptr ||
                       !mesh.position_color.empty();
    if (outside.inside) {
        look.color = *outside.inside;
        look.roughness = 0.7;
        return look;
    }
    if (outside.metallic > 0.5) {
        look.color = outside.color;
        look.metallic = outside.metallic;
        look.roughness = std::max(0.45, outside.roughness);  // as a saw leaves it
        return look;
    }
    if (outside.clear > 0.5) {
        look.color = outside.color;
        look.clear = outside.clear;
        look.roughness = std::max(0.3, outside.roughness);
        return look;
    }
    look.color = hides ? kPale : Vec3(outside.color + kPaler * (kPale - outside.color));
    look.roughness = 0.7;
    return look;
}

namespace {

// Of those that are not the mesh's own, which take colours, as all that are read do.
int number_of(const TriMesh& mesh, const std::string& name) {
    const auto known =
        std::find_if(mesh.material.begin(), mesh.material.end(),
                     [&](const SurfaceMaterial& m) { return m.name == name && !m.takes_colors; });
    return static_cast<int>(known - mesh.material.begin());
}

}  // namespace

int cut_material(TriMesh& mesh, const TriMesh& like) {
    if (mesh.material.empty()) mesh.material.emplace_back();
    const int number = number_of(mesh, kCutMaterial);
    if (number == static_cast<int>(mesh.material.size())) mesh.material.push_back(cut_look(like));
    return number;
}

int inside_material(TriMesh& mesh, const SurfaceMaterial& look) {
    const int number = number_of(mesh, look.name);
    if (number == static_cast<int>(mesh.material.size())) mesh.material.push_back(look);
    return number;
}

std::string cut_name(const std::string& inside) { return std::string(kCutMaterial) + "_" + inside; }

bool is_cut_look(const SurfaceMaterial& look) {
    return !look.takes_colors && (look.name == kCutMaterial || look.name.starts_with(cut_name("")));
}

NewLook::NewLook(const TriMesh& mesh)
    : mesh_(mesh), tree_(mesh), adjoins_(adjoining(mesh)), chart_(charts_of(adjoins_)) {
    if (mesh_.material.empty()) mesh_.material.emplace_back();
}

bool NewLook::is_textured(int triangle) const {
    if (mesh_.triangle_uv.empty()) return false;
    const Corners& uv = mesh_.triangle_uv[triangle];
    return uv[0] >= 0 && uv[1] >= 0 && uv[2] >= 0;
}

Vec2 NewLook::texture_at(int triangle, const Vec3& weight) const {
    Vec2 at = Vec2::Zero();
    for (int c = 0; c < 3; ++c) at += weight[c] * mesh_.uv[mesh_.triangle_uv[triangle][c]];
    return at;
}

// The triangles within reach of the middle to which the texture goes on from this one.
std::vector<int> NewLook::patch_about(int triangle, const Vec3& middle, double reach) const {
    std::vector<int> patch = {triangle};
    std::set<int> seen = {triangle};
    for (std::size_t n = 0; n < patch.size(); ++n) {
        for (int other : adjoins_[patch[n]]) {
            if (other < 0 || !seen.insert(other).second) continue;
            const auto& [a, b, c] = mesh_.triangle[other];
            const Vec3 &p = mesh_.position[a], &q = mesh_.position[b], &r = mesh_.position[c];
            const Vec3 low = p.cwiseMin(q).cwiseMin(r), high = p.cwiseMax(q).cwiseMax(r);
            const Vec3 near = middle.cwiseMax(low).cwiseMin(high);
            if ((near - middle).norm() <= reach) patch.push_back(other);
        }
    }
    return patch;
}

double NewLook::texture_scale(int triangle) const {
    const Corners& uv = mesh_.triangle_uv[triangle];
    const Vec2 u = mesh_.uv[uv[1]] - mesh_.uv[uv[0]], v = mesh_.uv[uv[2]] - mesh_.uv[uv[0]];
    const double area = area_of(mesh_, static_cast<std::size_t>(triangle));
    return area > 0 ? std::sqrt(0.5 * std::abs(u.x() * v.y() - u.y() * v.x()) / area) : 0;
}

struct NewLook::Face {
    int like = 0;  // triangle of the mesh
    bool textured = false;
    std::array<Vec2, 3> uv;
};

NewLook::Face NewLook::look_of(const std::array<Vec3, 3>& place,
                               const std::array<TriangleTree::Nearest, 3>& corner) const {
    const Vec3 middle = (place[0] + place[1] + place[2]) / 3;
    const TriangleTree::Nearest at = tree_.nearest(middle);
    Face face{at.triangle, is_textured(at.triangle), {}};
    if (!face.textured) return face;
    const Vec2 here = texture_at(at.triangle, at.weight);
    const double most = kStretch * texture_scale(at.triangle);
    double reach = 0;
    for (const Vec3& p : place) reach = std::max(reach, (p - middle).norm());
    std::vector<int> beyond;  // corners that lie nearest to another part of the texture
    for (int k = 0; k < 3; ++k) {
        const auto [triangle, weight] = corner[k];
        if (chart_[triangle] == chart_[at.triangle] && is_textured(triangle)) {
            face.uv[k] = texture_at(triangle, weight);
            if ((face.uv[k] - here).norm() <= most * (place[k] - middle).norm()) continue;
        }
        beyond.push_back(k);
    }
    if (beyond.empty()) return face;
    // Those go no farther than the seam.
    const std::vector<int> patch = patch_about(at.triangle, middle, reach);
    TriMesh part;
    for (int t : patch) {
        const int first = static_cast<int>(part.position.size());
        for (int v : mesh_.triangle[t]) part.position.push_back(mesh_.position[v]);
        part.triangle.push_back({first, first + 1, first + 2});
    }
    const TriangleTree tree(part);
    for (int k : beyond) {
        const TriangleTree::Nearest nearest = tree.nearest(place[k]);
        face.uv[k] = texture_at(patch[nearest.triangle], nearest.weight);
    }
    return face;
}

void NewLook::paint(const std::vector<Vec3>& place, TriMesh& mesh) const {
    std::vector<TriangleTree::Nearest> near(place.size());
    parallel_each(place.size(), kChunk, [&](std::size_t v) { near[v] = tree_.nearest(place[v]); });
    const std::size_t count = mesh.triangle.size();
    std::vector<Face> face(count);
    parallel_each(count, kChunk, [&](std::size_t t) {
        const auto& [a, b, c] = mesh.triangle[t];
        if (mesh.triangle_material[t] == 1) {
            face[t].like = near[a].triangle;
            return;
        }
        face[t] = look_of({place[a], place[b], place[c]}, {near[a], near[b], near[c]});
    });
    mesh.material = mesh_.material;
    const bool has_cut = std::find(mesh.triangle_material.begin(), mesh.triangle_material.end(),
                                   1) != mesh.triangle_material.end();
    const int cut = has_cut ? cut_material(mesh, mesh_) : -1;
    mesh.part_name = mesh_.part_name;
    if (!mesh_.triangle_part.empty()) mesh.triangle_part.resize(count);
    if (!mesh_.triangle_uv.empty()) mesh.triangle_uv.assign(count, {-1, -1, -1});
    std::map<std::tuple<int, double, double>, int> made;  // values, by vertex
    for (std::size_t t = 0; t < count; ++t) {
        const bool is_cut = mesh.triangle_material[t] == 1;
        const int own = mesh_.triangle_material.empty() ? 0 : mesh_.triangle_material[face[t].like];
        mesh.triangle_material[t] = is_cut ? cut : own;
        if (!mesh.triangle_part.empty()) {
            mesh.triangle_part[t] = mesh_.triangle_part[face[t].like];
        }
        if (!face[t].textured) continue;
        for (int k = 0; k < 3; ++k) {
            const Vec2& uv = face[t].uv[k];
            const auto [entry, fresh] = made.emplace(
                std::tuple(mesh.triangle[t][k], uv.x(), uv.y()), static_cast<int>(mesh.uv.size()));
            if (fresh) mesh.uv.push_back(uv);
            mesh.triangle_uv[t][k] = entry->second;
        }
    }
    if (mesh_.position_color.empty()) return;
    for (const auto& [triangle, weight] : near) {
        Eigen::Vector3f color = Eigen::Vector3f::Zero();
        for (int c = 0; c < 3; ++c) {
            color += float(weight[c]) * mesh_.position_color[mesh_.triangle[triangle][c]];
        }
        mesh.position_color.push_back(color);
    }
}

}  // namespace swage
