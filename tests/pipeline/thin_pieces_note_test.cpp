// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/thin_pieces_note.h"

#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

// Of a block of 12 cells of 0.1 m, cut across through the middle of each of these.
std::vector<std::string> told_of(const std::vector<int>& cut_cells, bool meet = true,
                                 const Material& material = {},
                                 Solver solver = Solver::quasistatic) {
    std::vector<WorkPiece> bodies(1);
    bodies[0].matter = test::make_block(12, 3, 3, 0.1, material);
    for (int cell : cut_cells) {
        const double x = 0.1 * (cell - 6) + 0.05;
        test::sever_plane(bodies[0].matter, Vec3(x, 0, 0), Vec3::UnitX());
    }
    SimSettings sim;
    sim.self_contact = meet;
    sim.solver = solver;
    return thin_pieces_notes(bodies, sim);
}

}  // namespace

TEST_CASE("pieces that blades left no whole cell of are told of where pieces meet at rest") {
    const std::vector<std::string> told = told_of({3, 4, 5});
    REQUIRE(told.size() == 1);
    CHECK(told[0].find("2 of the 4 pieces of the work-piece hold no whole cell: other pieces sink "
                       "into them by up to half a cell, and they into each other wholly; ") == 0);
    const std::vector<std::string> single = told_of({3, 4});
    REQUIRE(single.size() == 1);
    CHECK(single[0].find("1 of the 3 pieces of the work-piece holds no whole cell: other pieces "
                         "sink into it by up to half a cell; ") == 0);
    CHECK(told_of({3, 5, 7}).empty());  // a whole cell in each
    CHECK(told_of({}).empty());
    CHECK(told_of({3, 4, 5}, false).empty());
    Material breaks;
    breaks.strength = 1e6, breaks.toughness = 10;
    CHECK(told_of({3, 4, 5}, true, breaks).empty());
    CHECK(told_of({3, 4, 5}, true, {}, Solver::explicit_steps).empty());
}
