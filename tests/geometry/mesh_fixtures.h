// SPDX-License-Identifier: GPL-3.0-or-later
// Small meshes, and folders to keep their files in.
#pragma once

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh_read.h"
#include "geometry/mesh_repair.h"
#include "geometry/trimesh.h"
#include "tests/catch.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"

namespace swage::test {

using Folder = Scratch;

// The bytes of a number, as binary files hold it.
template <typename T>
std::string raw(T value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

inline TriMesh read_quietly(const std::filesystem::path& file) {
    std::vector<std::string> finding;
    return read_mesh(file, {}, &finding);
}

// Whether the account of a repair says so; what it says is shown where a check fails.
inline bool told(const Repair& repair, const std::string& what) {
    for (const std::string& line : repair.account)
        if (line.find(what) != std::string::npos) return true;
    for (const std::string& line : repair.account) UNSCOPED_INFO(line);
    return false;
}

// Unit cube of quads, outward, with a texture square on each face.
inline std::string cube_obj() {
    return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
           "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
           "f 1/1 4/2 3/3 2/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\n"
           "f 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4/1 1/2 5/3 8/4\n";
}

// A box of triangles, outward; `inward` turns it.
inline TriMesh box_mesh(const Vec3& low, const Vec3& high, bool inward = false) {
    TriMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.position.emplace_back((i & 1) ? high.x() : low.x(), (i & 2) ? high.y() : low.y(),
                                   (i & 4) ? high.z() : low.z());
    mesh.triangle = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    if (inward)
        for (Corners& t : mesh.triangle) std::swap(t[0], t[1]);
    return mesh;
}

inline void append(TriMesh& mesh, const TriMesh& other) {
    const int base = static_cast<int>(mesh.position.size());
    mesh.position.insert(mesh.position.end(), other.position.begin(), other.position.end());
    for (const Corners& t : other.triangle)
        mesh.triangle.push_back({t[0] + base, t[1] + base, t[2] + base});
}

// A sphere of about 2 * across^2 triangles with texture coordinates and one material.
inline TriMesh ball_mesh(int across, double radius) {
    TriMesh mesh;
    const int rings = across, around = 2 * across;
    mesh.position.push_back({0, 0, -radius});
    for (int r = 1; r < rings; ++r)
        for (int a = 0; a < around; ++a) {
            const double latitude = kPi * (static_cast<double>(r) / rings - 0.5);
            const double longitude = 2 * kPi * a / around;
            mesh.position.push_back(radius * Vec3(std::cos(latitude) * std::cos(longitude),
                                                  std::cos(latitude) * std::sin(longitude),
                                                  std::sin(latitude)));
        }
    mesh.position.push_back({0, 0, radius});
    const int last = static_cast<int>(mesh.position.size()) - 1;
    const auto at = [&](int r, int a) { return 1 + (r - 1) * around + a % around; };
    for (int a = 0; a < around; ++a) {
        mesh.triangle.push_back({0, at(1, a + 1), at(1, a)});
        mesh.triangle.push_back({last, at(rings - 1, a), at(rings - 1, a + 1)});
        for (int r = 1; r + 1 < rings; ++r) {
            mesh.triangle.push_back({at(r, a), at(r, a + 1), at(r + 1, a + 1)});
            mesh.triangle.push_back({at(r, a), at(r + 1, a + 1), at(r + 1, a)});
        }
    }
    for (const Vec3& p : mesh.position) mesh.uv.emplace_back(p.x() / radius, p.z() / radius);
    mesh.triangle_uv = mesh.triangle;
    mesh.material.push_back({});
    mesh.material[0].name = "skin";
    mesh.triangle_material.assign(mesh.triangle.size(), 0);
    return mesh;
}

// With the first of `what` in it.
inline std::string replaced(std::string text, const std::string& what, const std::string& with) {
    const std::size_t at = text.find(what);
    if (at != std::string::npos) text.replace(at, what.size(), with);
    return text;
}

}  // namespace swage::test
