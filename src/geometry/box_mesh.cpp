// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/box_mesh.h"

#include <algorithm>

#include "geometry/polygon.h"

namespace swage {

TriMesh box_mesh(const Box& box) {
    TriMesh mesh;
    for (int c = 0; c < 8; ++c) mesh.position.push_back(box.corner(c));
    for (const std::array<int, 4>& face : {std::array{0, 4, 6, 2},
                                           {1, 3, 7, 5},
                                           {0, 1, 5, 4},
                                           {2, 6, 7, 3},
                                           {0, 2, 3, 1},
                                           {4, 5, 7, 6}}) {
        for (const Corners& half : halves(face)) mesh.triangle.push_back(half);
    }
    return mesh;
}

std::optional<Box> box_it_is(const TriMesh& mesh) {
    const Box box = box_of(mesh.position);
    const auto is_corner = [&](const Vec3& p) {
        return ((p.array() == box.low.array()) || (p.array() == box.high.array())).all();
    };
    if (box.empty() || !std::ranges::all_of(mesh.position, is_corner)) return std::nullopt;
    constexpr double kRoundOff = 1e-9;
    const double whole = box.size().prod();
    if (!(std::abs(signed_volume(mesh) - whole) <= kRoundOff * whole)) return std::nullopt;
    return box;
}

}  // namespace swage
