// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/row_groups.h"

#include <set>

#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;

TEST_CASE("each run of cells is in the one group of its coarse row, and groups keep their order") {
    // With a hole through it, so that rows have several runs.
    std::vector<Vec3i> cells;
    const Vec3i size(9, 7, 5);
    for (int k = 0; k < size.z(); ++k) {
        for (int j = 0; j < size.y(); ++j) {
            for (int i = 0; i < size.x(); ++i) {
                if (i < 3 || i > 5 || j < 2 || j > 4) cells.emplace_back(i, j, k);
            }
        }
    }
    const Lattice lattice = make_lattice(Vec3::Zero(), 1, size, cells);
    for (const Vec3i& ratio : {Vec3i(1, 1, 1), Vec3i(2, 2, 2), Vec3i(3, 2, 4)}) {
        const Vec3i coarse = (size + ratio - Vec3i::Ones()).cwiseQuotient(ratio);
        const RowGroups rows(lattice.cell_run, coarse, ratio);
        REQUIRE(rows.count() == std::size_t(coarse.y()) * coarse.z());
        std::set<std::size_t> seen;
        for (int k = 0; k < coarse.z(); ++k) {
            for (int j = 0; j < coarse.y(); ++j) {
                const auto group = rows.of(j, k);
                CHECK(std::is_sorted(group.begin(), group.end()));
                for (std::size_t r : group) {
                    CHECK(lattice.cell_run[r].j / ratio.y() == j);
                    CHECK(lattice.cell_run[r].k / ratio.z() == k);
                    CHECK(seen.insert(r).second);
                }
            }
        }
        CHECK(seen.size() == lattice.cell_run.size());
    }
}
