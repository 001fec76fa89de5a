// SPDX-License-Identifier: GPL-3.0-or-later
// Matter that has flowed, and breaks.
#include "sim/lattice_forces.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/halved_cell.h"

using namespace swage;
using namespace swage::test;

// Pressed until it has flowed far, then pulled: it breaks by its elastic strain, when it is about
// as long again as it was.
TEST_CASE("cells of two like materials that have flowed break as those of one do") {
    const Material metal{.young_modulus = 1e9,
                         .poisson_ratio = 0.3,
                         .density = 1000,
                         .yield_stress = 1e7,
                         .hardening = 2e8,
                         .strength = 1.8e7,
                         .toughness = 8e4};
    const Forces seen = GENERATE(Forces::fresh, Forces::stale);
    std::vector<double> broke_at;
    for (const bool mixed : {false, true}) {
        Aggregate m = make_block(2, 2, 2, 0.01, metal);
        if (mixed) {
            m.inset.push_back(metal);
            m.cell_material.assign(m.cell_fill.size(), 0);
            for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
                m.mixed_cell.push_back(halved_cell(CellId(c)));
            }
        }
        LatticeForces lattice(m, Excess::lives_on);
        const auto crack_at = [&](double strain) {
            for (std::size_t p = 0; p < m.particle_count(); ++p) {
                const Vec3& x = m.particle_reference.at(p);
                const double across = 1 - 0.45 * strain;
                m.particle_position.set(p, {(1 + strain) * x.x(), across * x.y(), across * x.z()});
            }
            Vec3Array force;
            lattice.find(m, Flow::trial, force);
            lattice.commit(m, seen);
            return lattice.crack(m, seen).cells;
        };
        for (int n = 1; n <= 25; ++n) REQUIRE(crack_at(-0.002 * n) == 0);
        double strain = -0.05;
        while (strain < 0.1 && crack_at(strain) == 0) strain += 0.0005;
        REQUIRE(strain < 0.1);
        broke_at.push_back(strain);
    }
    CHECK(broke_at[0] < 0.2 * metal.strength / metal.young_modulus);
    CHECK(broke_at[1] == Approx(broke_at[0]).margin(0.0011));
}
