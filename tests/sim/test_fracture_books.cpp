// SPDX-License-Identifier: GPL-3.0-or-later
// The books of matter that breaks.
#include <random>

#include "sim/advance.h"
#include "sim/fracture_laws.h"
#include "sim/lattice_forces.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/motion.h"

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

void stretch(Aggregate& m, const Vec3& by) {
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, m.particle_reference.at(p).cwiseProduct(by));
    }
}

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

// Four cells around an edge, of which one has flowed to be longer along it than the others.
TEST_CASE("a connection that breaks in motion sets no energy free where a cell presses on it") {
    Aggregate m = make_block(1, 2, 2, kCell, kChalk);
    const FractureLaws laws(m);
    const double broken = laws.of_connection(0, 0).broken, longer = 3 * broken;
    m.cell_cracked.assign(4, 1);
    CellSet set{0, {}};
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        if (kCellConnection[slot].direction == 0) set.strain[slot] = float(longer);
    }
    m.lay_down(set);
    LatticeForces forces(m, Excess::lives_on);
    // Those that are pulled have next to nothing left.
    stretch(m, {1 + 0.9999 * broken, 1, 1});
    for (int n = 0; n < 3; ++n) forces.commit(m);
    stretch(m, {1 + 1.0001 * broken, 1, 1});
    const double before = forces.elastic_energy(m);
    int count = 0;
    double lost = 0;
    for (int n = 0; n < 3; ++n) {
        const Committed now = forces.commit(m);
        count += now.broken;
        lost += now.fracture;
        CHECK(now.fracture >= -1e-5 * before);  // kept as floats
    }
    CHECK(count > 0);
    const double after = forces.elastic_energy(m);
    CHECK(after <= (1 + 1e-5) * before);
    CHECK(before - after == Approx(lost).margin(1e-3 * before));  // and what was pulled
    // What is pressed still bears that.
    const double pressed = (1 + broken) / (1 + longer) - 1;
    const double own = 4 * 0.5 * 0.25 * 0.4 * kChalk.young_modulus * kCell *
                       std::pow(pressed * (1 + longer) * kCell, 2);
    CHECK(after > 0.2 * own);
    // And back from what was kept.
    CHECK(LatticeForces(m).elastic_energy(m) == after);
}

TEST_CASE("a block that flows and breaks on a floor is followed by energy-stepped steps") {
    Material material = kChalk;
    material.yield_stress = 4e4;
    Aggregate m = make_block(3, 3, 3, 0.08 / 3, material);
    const Quat turn(Eigen::AngleAxisd(0.54, Vec3(0.3, 0.4, 0.2).normalized()));
    double low = 0;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, turn * m.particle_reference.at(p));
        low = std::min(low, m.particle_position.at(p).y());
        m.particle_velocity.set(p, Vec3(0.3, -3, 0));
    }
    for (double& y : m.particle_position.y) y += 0.001 - low;
    const double energy = 0.5 * m.mass() * (0.09 + 9);
    const Apparatus floor = floor_with(0);
    Simulation simulation(m, floor, motion_settings(Solver::energy_stepped));
    FrameReport r;
    int broken = 0;
    for (int f = 1; f <= 10; ++f) {
        r = simulation.advance(floor_at(0.001 * (f - 1)), floor_at(0.001 * f));
        broken += r.broken;
    }
    CHECK(broken > 20);
    CHECK(std::abs(r.remainder) < 1e-3 * energy);
}
