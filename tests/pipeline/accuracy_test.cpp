// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/accuracy.h"

#include "tests/catch.h"

using namespace swage;

TEST_CASE("the accuracy told of a resolution is the worst that was measured, and of second order") {
    // swage verify oblique-bar oblique-rod, worst direction.
    for (const auto& [cells, bending, torsion] :
         {std::tuple(4.0, 0.0562, 0.0682), std::tuple(8.0, 0.0135, 0.0193)}) {
        CHECK(accuracy_at(cells).bending >= bending);
        CHECK(accuracy_at(cells).bending < 1.2 * bending);
        CHECK(accuracy_at(cells).torsion >= torsion);
        CHECK(accuracy_at(cells).torsion < 1.2 * torsion);
    }
    const int enough = accuracy_at(4).cells_for_percent;
    CHECK(accuracy_at(enough).torsion <= 0.01);
    CHECK(accuracy_at(enough).bending <= 0.01);
    CHECK(accuracy_at(enough - 1).torsion > 0.01);
}
