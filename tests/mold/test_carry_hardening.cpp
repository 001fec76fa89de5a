// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/carry_hardening.h"

#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

double middle_x(const Aggregate& m, std::size_t cell) {
    double x = 0;
    for (ParticleId p : m.lattice.cell_corners(static_cast<CellId>(cell))) {
        x += 0.125 * m.particle_reference.at(p).x();
    }
    return x;
}

}  // namespace

TEST_CASE("what is molded anew is as hard, place by place, as the matter that was there") {
    const Mechanics mechanics = GENERATE(Mechanics::cells, Mechanics::springs);
    const Material metal{.mechanics = mechanics, .yield_stress = 1e3};
    Aggregate old = make_block(8, 4, 4, 0.1, metal);
    for (std::size_t c = 0; c < old.cell_fill.size(); ++c) {
        old.cell_history.hardening().push_back(static_cast<float>(1 + middle_x(old, c)));
    }
    deform(old, [](const Vec3& x) { return Vec3(1.25 * x.x(), 0.9 * x.y(), 0.9 * x.z()); });
    Aggregate anew = make_block(10, 4, 4, 0.1, metal);  // sticks out a little at the sides
    carry_hardening(old, anew);
    const std::vector<float>& hardening = anew.cell_history.hardening();
    REQUIRE(hardening.size() == anew.cell_fill.size());
    for (std::size_t c = 0; c < anew.cell_fill.size(); ++c) {
        CHECK(std::abs(hardening[c] - (1 + middle_x(anew, c) / 1.25)) < 0.051);
    }
    // All of its history is there, and nothing of it but this.
    if (mechanics == Mechanics::cells) {
        for (int n = 0; n + 1 < kCellHistory; ++n) {
            CHECK(anew.cell_history.row[n] == std::vector<float>(anew.cell_fill.size(), 0.0f));
        }
    } else {
        CHECK(anew.cell_history.row[0].empty());
        CHECK(anew.cell_plastic[0] == std::vector<float>(anew.cell_fill.size(), 0.0f));
    }
}

TEST_CASE("what never flowed gives nothing to what is molded anew") {
    const Aggregate old = make_block(2, 2, 2, 0.1, Material{});
    Aggregate anew = old;
    carry_hardening(old, anew);
    CHECK(anew.cell_history.empty());
}
