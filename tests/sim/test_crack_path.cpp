// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/crack_path.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;

TEST_CASE("where nothing is drawn out the track of a crack lies across the cell's own pull") {
    Material brittle{.young_modulus = 1e6};
    brittle.strength = 1e4, brittle.toughness = 10;
    Aggregate m = test::make_block(9, 5, 5, 0.1, brittle);
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
