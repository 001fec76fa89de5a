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

}  // namespace swage
