// SPDX-License-Identifier: GPL-3.0-or-later
// A lattice of springs has one law: what its material says of elasticity is of cells.
#include "sim/free_flight.h"
#include "sim/material_laws.h"
#include "sim/wrinkled_foam.h"
#include "tests/catch.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

Aggregate pressed_block(Elasticity elasticity, Mechanics mechanics = Mechanics::springs) {
    Material material = kSpringy;
    material.elasticity = elasticity;
    material.mechanics = mechanics;
    Aggregate m = make_block(3, 3, 3, 0.01, material);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, m.particle_reference.at(p).cwiseProduct(Vec3(1.1, 0.4, 1.1)));
    }
    return m;
}

}  // namespace

TEST_CASE("springs have one law, whatever elasticity their material has") {
    const Aggregate plain = pressed_block(Elasticity::hencky);
    for (const Elasticity elasticity : {Elasticity::neo_hookean, Elasticity::storakers}) {
        const Aggregate springs = pressed_block(elasticity),
                        cells = pressed_block(elasticity, Mechanics::cells);
        CHECK(material_laws(springs).front().kind == CellKind::elastic);
        CHECK(material_laws(cells).front().kind != CellKind::elastic);
        CHECK(elastic_rounding(springs) == elastic_rounding(plain));
        CHECK(elastic_rounding(cells) > elastic_rounding(plain));
        CHECK_FALSE(foam_wrinkles(springs));
        CHECK(foam_wrinkles(cells) == (elasticity == Elasticity::storakers));
    }
}

TEST_CASE("springs of any material take the same steps to the same places") {
    const auto moved = [](Elasticity elasticity, Solver solver) {
        Aggregate m = pressed_block(elasticity);
        const Apparatus nothing;
        Simulation simulation(m, nothing, motion_settings(solver));
        const FrameReport r = simulation.advance(still(0), still(2e-3));
        std::vector<double> all = {double(r.steps), r.elastic};
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            const Vec3 x = m.particle_position.at(p);
            all.insert(all.end(), {x.x(), x.y(), x.z()});
        }
        return all;
    };
    for (const Solver solver : {Solver::explicit_steps, Solver::energy_stepped}) {
        const std::vector<double> plain = moved(Elasticity::hencky, solver);
        CHECK(moved(Elasticity::neo_hookean, solver) == plain);
        CHECK(moved(Elasticity::storakers, solver) == plain);
    }
}
