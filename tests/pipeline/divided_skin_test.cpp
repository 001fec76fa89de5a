// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "pipeline/work_piece.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;

TEST_CASE("a skin is divided as finely as the scene asks, also once it is molded anew") {
    InputMesh input;
    input.mesh = test::box_mesh({-0.2, -0.05, -0.1}, {0.2, 0.05, 0.1});
    BodySpec body;
    body.mold.across = 3;
    const double asked = GENERATE(3., kLongestSkinEdge, 0.5);
    const SkinSettings settings = {SkinKind::mount, asked};
    const WorkPiece piece = make_work_piece(input, body, settings);
    const double a = piece.matter.lattice.spacing;
    for (const TriMesh& skin : {piece.skin, mold_anew(piece, body, settings).skin}) {
        double longest = 0;
        for (const auto& [u, v, w] : skin.triangle) {
            longest = std::max({longest, (skin.position[u] - skin.position[v]).norm(),
                                (skin.position[v] - skin.position[w]).norm(),
                                (skin.position[w] - skin.position[u]).norm()});
        }
        CHECK(longest <= asked * a);
        CHECK(longest > 0.4 * asked * a);
    }
}
