// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/pipeline/pyramid.h"

namespace swage::test {

TriMesh pyramid(const std::filesystem::path& texture) {
    TriMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.1, 0.2, 1.0 / 3}};
    mesh.triangle = {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}};
    mesh.uv = {{0.5, 0}, {1, 0.25}};
    mesh.triangle_uv = {{0, 1, 1}, {0, 1, 1}, {0, 1, 0}, {0, 1, 1}};
    mesh.triangle_material = {0, 0, 0, 0};
    mesh.material.resize(1);
    mesh.material[0].name = "hide";
    mesh.material[0].texture = texture;
    smooth_by_crease_angle(mesh);
    return mesh;
}

TriMesh with_cut(TriMesh mesh) {
    mesh.triangle.push_back({2, 3, 4});
    mesh.triangle_uv.push_back({-1, -1, -1});
    mesh.triangle_material.push_back(1);
    mesh.material.push_back({"cut", {0.5, 0.25, 1}});
    mesh.material.back().takes_colors = false;
    mesh.material.back().clear = 0.75;
    smooth_by_crease_angle(mesh);
    return mesh;
}

}  // namespace swage::test
