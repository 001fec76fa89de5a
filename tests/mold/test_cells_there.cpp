// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/cells_there.h"

#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

// Two cells of 1: one drawn out to 10 along x, and one beyond it.
Aggregate long_and_short(double second = 12) {
    Aggregate body = make_matter(Vec3::Zero(), 1, {3, 1, 1}, {{0, 0, 0}, {2, 0, 0}}, {1, 1});
    deform(body, [&](const Vec3& x) {
        return Vec3(x.x() > 1.5 ? x.x() - 2 + second : 10 * x.x(), x.y(), x.z());
    });
    return body;
}

}  // namespace

TEST_CASE("a place is in the cell that holds it, however near the middle of another is") {
    const Aggregate body = long_and_short();
    const std::vector<Vec3> place{{9.9, 0.5, 0.5}, {10.9, 0.5, 0.5}, {12.1, 0.5, 0.5}};
    CHECK(cells_there(body, place, 1) == std::vector<CellId>{0, 0, 1});
    // Beyond all boxes it is of that with the nearest middle.
    CHECK(cells_there(body, place, 0.5) == std::vector<CellId>{0, 1, 1});
    CHECK(cells_there(body, {{-50, 0, 0}, {50, 0, 0}}) == std::vector<CellId>{0, 1});
}

TEST_CASE("of the cells that suit a place that holds it comes first, then one within a spacing") {
    const Aggregate body = long_and_short();
    const auto any = [](std::size_t, CellId) { return true; };
    const std::vector<Vec3> place{{9.9, 0.5, 0.5}, {10.9, 0.5, 0.5}, {12.1, 0.5, 0.5}};
    CHECK(suited_cells_there(body, place, any) == std::vector<CellId>{0, 0, 1});
    // 9.99 lies in the first and 10.5 beside it, which suit the last two places alone.
    const auto late = [](std::size_t n, CellId cell) { return cell == 1 || n >= 2; };
    CHECK(suited_cells_there(body, {{9.99, 0, 0}, {12, 0, 0}, {9.99, 0, 0}, {10.5, 0, 0}}, late) ==
          std::vector<CellId>{1, 1, 0, 0});
    CHECK(suited_cells_there(long_and_short(10.5), place, any) == std::vector<CellId>{0, 1, 1});
    const auto none = [](std::size_t, CellId) { return false; };
    CHECK(suited_cells_there(body, place, none) == std::vector<CellId>{-1, -1, -1});
}
