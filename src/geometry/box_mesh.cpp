// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/box_mesh.h"

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

}  // namespace swage
