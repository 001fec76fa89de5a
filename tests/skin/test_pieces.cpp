// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/skin_pieces.h"

#include <algorithm>

#include "tests/skin/cut_fixture.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("pieces of a skin are the matter's, the heaviest first, hollows among them") {
    TriMesh mesh = bar();
    // A hollow in the right part.
    const int outer = static_cast<int>(mesh.triangle.size());
    const int first = static_cast<int>(mesh.position.size());
    TriMesh hollow = test::box_mesh(Vec3(.3, -.05, -.05), Vec3(.4, .05, .05));
    mesh.position.insert(mesh.position.end(), hollow.position.begin(), hollow.position.end());
    for (const Corners& t : hollow.triangle) {
        mesh.triangle.push_back({t[0] + first, t[2] + first, t[1] + first});
    }
    Fixture f(mesh);
    const auto pieces = [&] { return skin_pieces(f.mesh, f.mount, f.matter); };
    CHECK(pieces() == std::vector<int>(f.mesh.triangle.size(), 0));
    const auto cut_at = [&](double x) {
        f.cut(sweep_of({x, 0, 0}, Vec3::UnitX(), 1));
        test::sever_plane(f.matter, {x, 0, 0}, Vec3::UnitX());
        f.follow();
    };
    // Cut twice: 0.52, 0.31 and 0.17 long; the lightest in the middle.
    cut_at(.0213);
    cut_at(.1907);
    REQUIRE(parts_of(f.mesh).size() == 4);
    const std::vector<int> piece = pieces();
    for (std::size_t t = 0; t < piece.size(); ++t) {
        double x = 0;
        for (const int v : f.mesh.triangle[t]) x += f.mesh.position[v].x() / 3;
        if (std::abs(x - .0213) < 1e-6 || std::abs(x - .1907) < 1e-6) continue;  // of the cuts
        CHECK(piece[t] == (x < .0213 ? 0 : x > .1907 ? 1 : 2));
    }
    CHECK(std::count(piece.begin(), piece.end(), 1) > outer / 8);
}
