// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/shared/meshes.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include "geometry/edges.h"

namespace swage::test {

bool is_closed(const TriMesh& mesh) {
    bool closed = true;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        closed = closed && uses.size() == 2 && uses[0].forward != uses[1].forward;
    });
    return closed;
}

TriMesh sphere_mesh(double radius, int divisions) {
    const double g = std::numbers::phi;
    TriMesh mesh;
    mesh.position = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangle = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int n = 0; n < divisions; ++n) {
        std::map<std::pair<int, int>, int> middle;
        const auto between = [&](int a, int b) {
            const auto [at, made] =
                middle.try_emplace(std::minmax(a, b), static_cast<int>(mesh.position.size()));
            if (made) mesh.position.push_back(0.5 * (mesh.position[a] + mesh.position[b]));
            return at->second;
        };
        std::vector<Corners> finer;
        for (const auto& [a, b, c] : mesh.triangle) {
            const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        mesh.triangle = std::move(finer);
        for (Vec3& p : mesh.position) p.normalize();
    }
    for (Vec3& p : mesh.position) p = radius * p.normalized();
    return mesh;
}

TriMesh ring_mesh(int along, int across, const std::function<Vec3(double, double)>& at) {
    TriMesh mesh;
    for (int u = 0; u < along; ++u)
        for (int v = 0; v < across; ++v)
            mesh.position.push_back(
                at(2 * std::numbers::pi * u / along, 2 * std::numbers::pi * v / across));
    for (int u = 0; u < along; ++u) {
        for (int v = 0; v < across; ++v) {
            const int u1 = (u + 1) % along, v1 = (v + 1) % across;
            const int a = u * across + v, b = u1 * across + v, c = u1 * across + v1,
                      d = u * across + v1;
            mesh.triangle.push_back({a, b, c});
            mesh.triangle.push_back({a, c, d});
        }
    }
    return mesh;
}

TriMesh torus_mesh(double ring, double tube, int along, int across) {
    return ring_mesh(along, across, [=](double u, double v) {
        const double r = ring + tube * std::cos(v);
        return Vec3(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
    });
}

TriMesh knot_mesh(int along, int across) {
    const auto path = [](double u) {
        const double r = 1 + 0.45 * std::cos(3 * u);
        return Vec3(r * std::cos(2 * u), r * std::sin(2 * u), 0.45 * std::sin(3 * u));
    };
    return ring_mesh(along, across, [=](double u, double v) -> Vec3 {
        const Vec3 tangent = (path(u + 1e-4) - path(u - 1e-4)).normalized();
        const Vec3 side = tangent.cross(Vec3::UnitZ()).normalized();
        const double r = 0.2 + 0.02 * std::sin(40 * u) * std::cos(5 * v);
        return path(u) + r * (std::cos(v) * side + std::sin(v) * side.cross(tangent));
    });
}

TriMesh moved(TriMesh mesh, const Pose& pose) {
    for (Vec3& p : mesh.position) p = pose * p;
    return mesh;
}

TriMesh turned_inside_out(TriMesh mesh) {
    for (Corners& t : mesh.triangle) std::swap(t[1], t[2]);
    return mesh;
}

TriMesh together(const TriMesh& a, const TriMesh& b) {
    TriMesh mesh;
    mesh.position = a.position;
    mesh.triangle = a.triangle;
    const int first = static_cast<int>(a.position.size());
    mesh.position.insert(mesh.position.end(), b.position.begin(), b.position.end());
    for (const Corners& t : b.triangle)
        mesh.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
    return mesh;
}

}  // namespace swage::test
