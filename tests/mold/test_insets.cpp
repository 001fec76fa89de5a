// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/insets.h"

#include "base/error.h"
#include "tests/mold/checks.h"

using namespace swage;
using namespace swage::test;

namespace {

Aggregate with_inset(const TriMesh& body, const TriMesh& solid, int across) {
    Material light, heavy;
    light.density = 1000, heavy.density = 2000;
    MoldSettings settings;
    settings.across = across;
    return mold(body, light, settings, {{solid, heavy}});
}

// All that lies before a plane through `point`, as far as `reach`.
TriMesh half_space(const Vec3& point, const Vec3& normal, double reach) {
    const TriMesh box = box_mesh({-2 * reach, -reach, -reach}, {0, reach, reach});
    return moved(box, {turn_onto(Vec3::UnitX(), normal), point});
}

}  // namespace

TEST_CASE(
    "of an inset that reaches out of the body, that part is of its material that lies in it") {
    const TriMesh bar = box_mesh({-0.05, -0.01, -0.01}, {0.05, 0.01, 0.01});
    // Up to the plane x = 0.5 y - 0.02.
    TriMesh wedge;
    wedge.position = {{-1, -1, -1}, {-0.52, -1, -1}, {0.48, 1, -1}, {-1, 1, -1},
                      {-1, -1, 1},  {-0.52, -1, 1},  {0.48, 1, 1},  {-1, 1, 1}};
    wedge.triangle = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                      {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    CHECK(with_inset(bar, wedge, 6).mass() == Approx(0.052).epsilon(1e-5));
    // A plane through the middle of a bar halves it, whichever way it looks.
    for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(-1, 0.1, 0), Vec3(0.2, 1, 0), Vec3(0.1, -0.3, 1),
                               Vec3(-0.1, 0.7, -0.6), Vec3(3, 2, 1), Vec3(-2, 1, -3)}) {
        INFO("normal " << normal.transpose());
        for (int across : {2, 5}) {
            const TriMesh half = half_space(Vec3::Zero(), normal.normalized(), 1);
            CHECK(with_inset(bar, half, across).mass() == Approx(0.06).epsilon(1e-4));
        }
    }
}

TEST_CASE("cells of a box are filled as if the box were larger than what is in it") {
    const TriMesh knot = moved(knot_mesh(120, 16), some_turn());
    const MoldFrame all = frame_over(box_of(knot.position), 0.21);
    for (const Vec3i& first : {Vec3i(0, 0, 0), Vec3i(2, 3, 1), Vec3i(5, 1, 2)}) {
        MoldFrame part = all;
        part.origin = all.point(2 * first.cast<double>());
        part.cell_count = {6, 7, 4};
        REQUIRE((first + part.cell_count - all.cell_count).maxCoeff() <= 0);
        const auto whole = share_cells(knot, all), own = share_cells(knot, part);
        REQUIRE(own.size() == 4);
        std::size_t cells = 0;
        for (int k = 0; k < 4; ++k) {
            std::size_t next = 0;
            for (const CellFill& s : whole[first.z() + k].share) {
                const int i = s.i - first.x(), j = s.j - first.y();
                if (i < 0 || i >= 6 || j < 0 || j >= 7) continue;
                REQUIRE(next < own[k].share.size());
                const CellFill& same = own[k].share[next++];
                REQUIRE((same.i == i && same.j == j));
                CHECK(same.fill == Approx(s.fill).margin(1e-11));
                CHECK((same.moment - s.moment).norm() < 1e-11);
                ++cells;
            }
            CHECK(next == own[k].share.size());
        }
        CHECK(cells > 8);
    }
}

TEST_CASE("an inset that lies beside the body is refused") {
    const TriMesh bar = box_mesh({0, 0, 0}, {4, 1, 1});
    const TriMesh beside = box_mesh({0, 1.5, 0}, {4, 2, 1});
    CHECK_THROWS_AS(with_inset(bar, beside, 2), Error);
    CHECK_THROWS_AS(with_inset(bar, turned_inside_out(bar), 2), Error);
}

TEST_CASE("an inset too thin for its cells is not said to lie outside the body") {
    const TriMesh bar = box_mesh({-0.05, -0.01, -0.01}, {0.05, 0.01, 0.01});
    const auto told = [&](const TriMesh& solid) {
        std::vector<std::string> findings;
        MoldSettings settings;
        settings.across = 4;
        try {
            mold(bar, Material{}, settings, {{solid, Material{}}}, &findings);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return findings.empty() ? std::string() : findings.at(0);
    };
    // Cells of 5 mm; a slab across half of the section.
    const auto slab = [&](double thickness, double from) {
        return told(box_mesh({0.001, from, -0.005}, {0.001 + thickness, 0.005, 0.005}));
    };
    CHECK(slab(4e-6, -0.005) ==
          "cannot mold: inset 1 is less than a thousandth of each cell that it lies in");
    CHECK(slab(20e-6, -0.005).empty());
    // A tenth of a cell more on one side.
    CHECK(slab(40e-6, -0.0055) ==
          "4.76 % of inset 1 is less than a thousandth of its cell and is left out");
    CHECK(told(box_mesh({1, 1, 1}, {2, 2, 2})) ==
          "cannot mold: inset 1 lies outside the work-piece");
    CHECK(told(box_mesh({0.04, -0.01, -0.01}, {0.06, 0.01, 0.01})) ==
          "50 % of inset 1 lies outside the work-piece and is left out");
    // A box around what has rounded edges is meant to hold all of it.
    CHECK(told(box_mesh({-0.05, -0.0102, -0.01}, {0.05, 0.0102, 0.01})).empty());
}
