// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/sheets.h"

#include "tests/catch.h"

using namespace swage;

namespace {

void add_loop(Section& section, const std::vector<Vec2>& corners) {
    const int first = static_cast<int>(section.point.size()), count = int(corners.size());
    for (int n = 0; n < count; ++n) {
        section.point.push_back(corners[n]);
        section.at_rest.emplace_back(corners[n].x(), corners[n].y(), 0);
        section.segment.push_back({first + n, first + (n + 1) % count});
    }
}

}  // namespace

TEST_CASE("a hole is of the loop around it, also where a point of it lies on that loop") {
    for (const Vec2& tip : {Vec2(0.5, 0.3), Vec2(0.5, 0), Vec2(0, 0)}) {
        Section section;
        add_loop(section, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
        add_loop(section, {tip, {0.3, 0.6}, {0.5, 0.7}, {0.7, 0.6}});
        add_loop(section, {{2, 0}, {3, 0}, {3, 1}, {2, 1}});
        const std::vector<std::vector<int>> sheets = sheets_of(section);
        REQUIRE(sheets.size() == 2);
        CHECK(sheets[0].size() == 8);
        CHECK(sheets[1].size() == 4);
    }
}
