// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_edit.h"

#include <algorithm>
#include <utility>

namespace swage {

namespace {

template <typename T>
void filter(std::vector<T>& values, const std::vector<char>& keep) {
    if (values.empty()) return;
    std::size_t next = 0;
    for (std::size_t i = 0; i < keep.size(); ++i)
        if (keep[i]) values[next++] = values[i];
    values.resize(next);
}

template <typename T>
void join(std::vector<T>& here, std::size_t here_count, const std::vector<T>& there,
          std::size_t there_count, const T& filler) {
    if (here.empty() && there.empty()) return;
    here.resize(here_count, filler);
    here.insert(here.end(), there.begin(), there.end());
    here.resize(here_count + there_count, filler);
}

Corners shifted(Corners c, int by) {
    for (int& i : c)
        if (i >= 0) i += by;
    return c;
}

// Numbers of names: a mesh without any gets the filler's as soon as the other has some.
template <typename Name>
void join_named(std::vector<int>& here, std::vector<Name>& name, std::size_t here_count,
                std::vector<int> there, const std::vector<Name>& there_name,
                std::size_t there_count, const Name& filler) {
    if (here.empty() && there.empty()) return;
    if (here.empty()) {
        name.push_back(filler);
        here.assign(here_count, static_cast<int>(name.size()) - 1);
    }
    const int base = static_cast<int>(name.size());
    name.insert(name.end(), there_name.begin(), there_name.end());
    for (int& i : there) i += base;
    if (there.empty()) {
        name.push_back(filler);
        there.assign(there_count, static_cast<int>(name.size()) - 1);
    }
    here.insert(here.end(), there.begin(), there.end());
}

}  // namespace

void keep_triangles(TriMesh& mesh, const std::vector<char>& keep) {
    for_each_triangle_array([&](auto& values) { filter(values, keep); }, mesh);
}

void flip_triangle(TriMesh& mesh, std::size_t t) {
    for (std::vector<Corners>* corners : {&mesh.triangle, &mesh.triangle_uv, &mesh.triangle_smooth})
        if (!corners->empty()) std::swap((*corners)[t][1], (*corners)[t][2]);
}

void add_triangle(TriMesh& mesh, const Corners& corners, std::size_t like, const Corners& smooth) {
    mesh.triangle.push_back(corners);
    if (!mesh.triangle_uv.empty()) mesh.triangle_uv.push_back({-1, -1, -1});
    if (!mesh.triangle_smooth.empty()) mesh.triangle_smooth.push_back(smooth);
    if (!mesh.triangle_polygon.empty())
        mesh.triangle_polygon.push_back(mesh.triangle_polygon.back() + 1);
    if (!mesh.triangle_material.empty())
        mesh.triangle_material.push_back(int{mesh.triangle_material[like]});
    if (!mesh.triangle_part.empty()) mesh.triangle_part.push_back(int{mesh.triangle_part[like]});
}

void drop_unused_positions(TriMesh& mesh) {
    std::vector<char> used(mesh.position.size(), 0);
    for (const Corners& t : mesh.triangle)
        for (const int i : t) used[i] = 1;
    std::vector<int> place(used.size(), -1);
    int next = 0;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) place[i] = next++;
    filter(mesh.position, used);
    filter(mesh.position_color, used);
    for (Corners& t : mesh.triangle)
        for (int& i : t) i = place[i];
}

void append_mesh(TriMesh& mesh, const TriMesh& other) {
    const std::size_t here = mesh.triangle.size(), there = other.triangle.size();
    const int base = static_cast<int>(mesh.position.size());
    const int uv_base = static_cast<int>(mesh.uv.size());
    const auto moved = [](std::vector<Corners> corners, int by) {
        for (Corners& c : corners) c = shifted(c, by);
        return corners;
    };
    join<Eigen::Vector3f>(mesh.position_color, mesh.position.size(), other.position_color,
                          other.position.size(), Eigen::Vector3f::Ones());
    mesh.position.insert(mesh.position.end(), other.position.begin(), other.position.end());
    mesh.uv.insert(mesh.uv.end(), other.uv.begin(), other.uv.end());
    join(mesh.triangle_uv, here, moved(other.triangle_uv, uv_base), there, Corners{-1, -1, -1});
    if (!other.smooth_normal.empty()) {
        join<Vec3>(mesh.smooth_normal, mesh.smooth_group_count, other.smooth_normal,
                   other.smooth_group_count, Vec3::Zero());
    }
    if (!mesh.triangle_smooth.empty() && !other.triangle_smooth.empty()) {
        join(mesh.triangle_smooth, here, moved(other.triangle_smooth, mesh.smooth_group_count),
             there, Corners{0, 0, 0});
        mesh.smooth_group_count += other.smooth_group_count;
    } else {  // corners without groups get one each
        const auto give_groups = [&](std::size_t count) {
            std::vector<Corners> groups(count);
            for (Corners& c : groups)
                for (int& g : c) g = mesh.smooth_group_count++;
            return groups;
        };
        if (!mesh.triangle_smooth.empty()) {
            join(mesh.triangle_smooth, here, give_groups(there), there, Corners{0, 0, 0});
        } else if (!other.triangle_smooth.empty()) {
            mesh.smooth_group_count = other.smooth_group_count;
            mesh.triangle_smooth = give_groups(here);
            join(mesh.triangle_smooth, here, other.triangle_smooth, there, Corners{0, 0, 0});
        }
    }
    if (!mesh.triangle_polygon.empty() || !other.triangle_polygon.empty()) {
        const auto each_its_own = [](std::size_t count) {
            std::vector<int> polygon(count);
            for (std::size_t t = 0; t < count; ++t) polygon[t] = static_cast<int>(t);
            return polygon;
        };
        if (mesh.triangle_polygon.empty()) mesh.triangle_polygon = each_its_own(here);
        std::vector<int> more =
            other.triangle_polygon.empty() ? each_its_own(there) : other.triangle_polygon;
        const int next = mesh.triangle_polygon.empty() ? 0 : mesh.triangle_polygon.back() + 1;
        const int first = more.empty() ? 0 : *std::min_element(more.begin(), more.end());
        for (const int p : more) mesh.triangle_polygon.push_back(p - first + next);
    }
    SurfaceMaterial plain;
    plain.name = "default";
    join_named(mesh.triangle_material, mesh.material, here, other.triangle_material, other.material,
               there, plain);
    join_named(mesh.triangle_part, mesh.part_name, here, other.triangle_part, other.part_name,
               there, std::string("default"));
    for (const Corners& t : other.triangle) mesh.triangle.push_back(shifted(t, base));
}

}  // namespace swage
