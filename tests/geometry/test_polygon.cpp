// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/polygon.h"

#include <algorithm>

#include "tests/catch.h"

using namespace swage;

TEST_CASE("the halves of a quad turn as it does, fill it and meet at the diagonal named") {
    const std::array<Vec3, 4> p = {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(2, 2, 0), Vec3(0, 1, 0)};
    for (const Diagonal by : {Diagonal::first, Diagonal::second}) {
        const auto both = halves({0, 1, 2, 3}, by);
        double area = 0;
        for (const Corners& t : both) {
            const double own = 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).z();
            CHECK(own > 0);
            area += own;
            for (int end : {0, 2}) {
                const int corner = by == Diagonal::first ? end : end + 1;
                CHECK(std::count(t.begin(), t.end(), corner) == 1);
            }
        }
        CHECK(area == Approx(4));
    }
}

TEST_CASE("a quad with a corner that points in is cut so that both halves lie in it") {
    const std::vector<Vec3> p = {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0, 2, 0)};
    std::vector<Corners> triangle;
    CHECK(cut_polygon(p, triangle));
    REQUIRE(triangle.size() == 2);
    for (const Corners& t : triangle) {
        CHECK((p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).z() > 0);
    }
}
