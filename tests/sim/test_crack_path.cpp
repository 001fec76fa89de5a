// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/crack_path.h"

#include "sim/cracking.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;

namespace {

const Material kBrittle{.young_modulus = 1e9, .strength = 1e6, .toughness = 20};

std::vector<CellId> next_to_crack(const Aggregate& matter, const Fracture& law) {
    return cells_beyond_strength(matter, FractureLaws(law), nullptr, nullptr);
}

}  // namespace

TEST_CASE("where nothing is drawn out the track of a crack lies across the cell's own pull") {
    Aggregate m = test::make_block(9, 5, 5, 0.1, kBrittle);
    for (auto* x : {&m.particle_position.x, &m.particle_position.y, &m.particle_position.z}) {
        for (double& v : *x) v *= 0.99;
    }
    m.cell_cracked.assign(m.cell_fill.size(), 0);
    m.cell_cracked[m.lattice.cell_at(7, 2, 2)] = 1;
    const FractureLaws laws(m);
    const Vec3i site(4, 2, 2);
    for (int axis = 0; axis < 3; ++axis) {
        const StrainedCell cell{m.lattice.cell_at(4, 2, 2), site, Vec3::Unit(axis)};
        CHECK(off_track_factor(m, laws, cell) == (axis == 0 ? 2 : 1));
    }
}

TEST_CASE("cells in line with a cracked one are spared, those ahead of it are not") {
    Aggregate m = test::make_block(5, 5, 1, 1, kBrittle);
    for (std::size_t p = 0; p < m.particle_count(); ++p) m.particle_position.y[p] *= 1.01;
    const Fracture law = fracture_law(1, 0.9e-2, 1, 1);
    const auto at = [&](int i, int j) { return m.lattice.cell_at(i, j, 0); };
    Fracture soft = law;
    soft.onset = 0.9e-2;
    // Of those that crack at once none is in line with another.
    const std::vector<CellId> first = next_to_crack(m, soft);
    CHECK(first.size() >= 5);
    CHECK(first.size() <= 10);
    m.cell_cracked.assign(m.cell_fill.size(), 0);
    m.cell_cracked[at(1, 2)] = 1;
    const std::vector<CellId> next = next_to_crack(m, soft);
    CHECK(next.size() >= 4);
    for (CellId cell : next) CHECK(m.lattice.cell_site(cell).x() != 1);
    // But not for ever: beside a whole row of cracked ones any goes at twice its strength.
    for (int i = 0; i < 5; ++i) m.cell_cracked[at(i, 2)] = 1;
    soft.onset = 0.01 / 1.9;
    CHECK(next_to_crack(m, soft).empty());
    soft.onset = 0.01 / 2.1;
    CHECK_FALSE(next_to_crack(m, soft).empty());
}

TEST_CASE("a crack goes on across the pull, not along the lattice") {
    // Cracked three cells along x; the pull is turned by 30 degrees.
    Aggregate m = test::make_block(9, 9, 1, 1, kBrittle);
    const double turn = kPi / 6;
    const Vec3 pull(-std::sin(turn), std::cos(turn), 0);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        m.particle_position.set(p, x + 0.01 * pull.dot(x) * pull);
    }
    m.cell_cracked.assign(m.cell_fill.size(), 0);
    for (int i : {1, 2, 3}) m.cell_cracked[m.lattice.cell_at(i, 3, 0)] = 1;
    Fracture law = fracture_law(1, 0.9e-2, 1, 1);
    law.onset = 0.01 / 1.3;
    std::vector<Vec3i> near;
    for (CellId cell : next_to_crack(m, law)) {
        const Vec3i site = m.lattice.cell_site(cell);
        if (site.x() > 3 && site.x() < 6) near.push_back(site);
    }
    REQUIRE_FALSE(near.empty());
    for (const Vec3i& site : near) CHECK(site.y() > 3);
}
