// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "sim/advance.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("a bar of steel that strikes its like at its end stands, and the other goes on") {
    const Material steel{.young_modulus = 200e9,
                         .poisson_ratio = 0,
                         .density = 7850,
                         .damping_ratio = 0,
                         .friction = 0,
                         .restitution = 1};
    MoldSettings settings;
    settings.spacing = 0.005;
    const TriMesh mesh = make_shape("bar", {{"length", 0.2}, {"height", 0.02}, {"width", 0.02}})
                             .mesh;  // its edges are rounded
    Aggregate one = mold(mesh, steel, settings), other = mold(mesh, steel, settings);
    for (std::size_t p = 0; p < one.particle_count(); ++p) {
        one.particle_position.x[p] -= 0.20001;
        one.particle_velocity.x[p] = 2;
    }
    SimSettings motion;
    motion.solver = Solver::explicit_steps;
    const Apparatus nothing;
    Simulation simulation({&one, &other}, nothing, motion);
    const double given = 0.5 * one.mass() * 4;
    // They touch while a wave goes to and fro: 79 us.
    Drive start, end;
    end.time = 100e-6;
    const FrameReport r = simulation.advance(start, end);
    CHECK(r.body[1].kinetic > 0.98 * given);
    CHECK(r.body[0].kinetic < 0.01 * given);
    CHECK(std::abs(r.remainder) < 2e-3 * given);
}
