// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_overlap.h"

#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;

TEST_CASE("bodies that lie in each other at the start are told, those that touch are not") {
    const Aggregate one = test::make_block(4, 4, 4, 0.1, Material{});
    const auto told = [&](double spacing, int across, double away) {
        Aggregate other = test::make_block(across, across, across, spacing, Material{});
        for (double& x : other.particle_position.x) x += away;
        return start_overlaps({{"one", &one}, {"other", &other}});
    };
    CHECK(told(0.1, 4, 0.4).empty());  // face on face
    CHECK(told(0.04, 5, 0.301).empty());
    CHECK(told(0.1, 4, 1).empty());
    REQUIRE(told(0.1, 4, 0.3).size() == 1);
    CHECK(told(0.1, 4, 0.3)[0].find("\"one\" and \"other\"") != std::string::npos);
    CHECK(told(0.1, 4, 0.3)[0].find("16 cells") != std::string::npos);
    CHECK(told(0.04, 5, 0.1).size() == 1);
    CHECK(told(0.04, 5, 0.03).size() == 1);  // wholly inside
}
