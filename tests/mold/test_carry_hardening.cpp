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

TEST_CASE("what is molded anew has the back stress that the matter had, turned as it was") {
    const Material metal{
        .young_modulus = 1e6, .yield_stress = 1e3, .back_stress = 600, .back_strain = 0.01};
    Aggregate old = make_block(6, 4, 4, 0.1, metal);
    const std::size_t cells = old.cell_fill.size();
    old.cell_history.assign(cells);
    old.cell_back.assign(cells);
    const double shear = metal.young_modulus / 2.5;
    const double strain = 500 / (3 * shear);  // bears 500 Pa, pulled along x
    for (std::size_t c = 0; c < cells; ++c) {
        old.cell_history.hardening()[c] = 0.01f;
        old.cell_back.row[0][c] = static_cast<float>(strain);
        for (int n : {1, 2}) old.cell_back.row[n][c] = static_cast<float>(-0.5 * strain);
        old.cell_back.row[7][c] = 1e-3f;
    }
    const Mat3 turn = Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitZ()).toRotationMatrix();
    deform(old, [&](const Vec3& x) { return Vec3(turn * x); });
    Aggregate anew = make_block(4, 6, 4, 0.1, metal);
    carry_hardening(old, anew);
    REQUIRE(anew.cell_back.row[0].size() == cells);
    for (std::size_t c = 0; c < cells; ++c) {
        CHECK(anew.cell_back.row[1][c] == Approx(strain).epsilon(1e-5));
        CHECK(anew.cell_back.row[0][c] == Approx(-0.5 * strain).epsilon(1e-5));
        CHECK(std::abs(anew.cell_back.row[3][c]) < 1e-5 * strain);
        CHECK(anew.cell_back.row[7][c] == 0);
    }
    // 1000 - 600 (1 - e^-10) of surface are left: without stress there can be no more than that.
    for (float& one : old.cell_history.hardening()) one = 0.1f;
    carry_hardening(old, anew);
    CHECK(3 * shear * anew.cell_back.row[1][0] == Approx(400).epsilon(2e-3));
}
