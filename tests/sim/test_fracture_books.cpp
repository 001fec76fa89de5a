// SPDX-License-Identifier: GPL-3.0-or-later
// The books of matter that breaks.
#include <random>

#include "sim/lattice_forces.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

const Material kChalk{.young_modulus = 2e6,
                      .poisson_ratio = 0.3,
                      .density = 1000,
                      .strength = 9e4,
                      .toughness = 20,
                      .damping_ratio = 0,
                      .friction = 0,
                      .restitution = 1};
constexpr double kCell = 0.02;

}  // namespace

TEST_CASE(
    "cells that crack one after another, before what the first lose is remembered, lose all") {
    const Excess excess = GENERATE(Excess::lives_on, Excess::is_lost);
    Aggregate m = make_block(3, 3, 3, kCell, kChalk);
    std::mt19937 engine(7);
    std::normal_distribution<double> draw;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 off(draw(engine), draw(engine), draw(engine));
        m.particle_position.set(p, 1.03 * m.particle_reference.at(p) + 0.02 * kCell * off);
    }
    LatticeForces forces(m, excess);
    const double start = forces.elastic_energy(m);
    double lost = 0;
    int rounds = 0;
    for (Cracked cracked = forces.crack(m); cracked.cells > 0; cracked = forces.crack(m)) {
        lost += cracked.lost;
        ++rounds;
    }
    CHECK(rounds > 2);
    REQUIRE(forces.elastic_energy(m) < 0.99 * start);
    for (int n = 0; n < 8; ++n) {
        const Committed more = forces.commit(m);
        lost += more.fracture + forces.crack(m).lost;
    }
    CHECK(start - forces.elastic_energy(m) == Approx(lost).margin(1e-5 * start));
}
