// SPDX-License-Identifier: GPL-3.0-or-later
// Halves that were cut at rest, as motion begins.
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kCell = 0.1;

Aggregate cut_block(double off) {
    Aggregate block = make_block(6, 4, 4, kCell, kSpringy);
    sever_plane(block, Vec3(off * kCell, 0, 0), Vec3::UnitX());
    return block;
}

SimSettings meeting_itself() {
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    return settings;
}

}  // namespace

TEST_CASE("halves cut through a layer of particles, or next to one, hold nothing and lie still") {
    const double off = GENERATE(0., 1e-9, -1e-9, 1e-6, -1e-6, 1e-3, 0.4);
    Aggregate block = cut_block(off);
    const Apparatus nothing;
    Simulation simulation(block, nothing, meeting_itself());
    const FrameReport report = simulation.advance(still(0), still(1e-3));
    CHECK(report.contact_at_start < 1e-12);
    CHECK(report.contact < 1e-12);
    CHECK(report.kinetic < 1e-12);
}

namespace {

// The right half 0.3 cells in the left one, each going at the other.
Aggregate halves_in_each_other(double speed) {
    Aggregate block = cut_block(0.4);
    for (std::size_t p = 0; p < block.particle_count(); ++p) {
        const bool is_right = block.particle_reference.at(p).x() > 0.05;
        if (is_right) block.particle_position.add(p, Vec3(-0.3 * kCell, 0, 0));
        block.particle_velocity.set(p, Vec3(is_right ? -speed : speed, 0, 0));
    }
    return block;
}

}  // namespace

TEST_CASE("what went through each other while it could not touch is not thrown apart") {
    const bool unpressed = GENERATE(true, false);
    Aggregate block = halves_in_each_other(0);
    const Apparatus nothing;
    Simulation simulation(block, nothing, meeting_itself());
    simulation.take_on({}, unpressed);
    const FrameReport report = simulation.advance(still(0), still(1e-3));
    CHECK((report.kinetic < 1e-12) == unpressed);
    CHECK((report.contact_at_start < 1e-12) == unpressed);
}

TEST_CASE("what went through each other while it could not touch pushes what presses it on") {
    Aggregate block = halves_in_each_other(0.5);
    const Apparatus nothing;
    Simulation simulation(block, nothing, meeting_itself());
    simulation.take_on({}, true);
    double most = 0;
    for (int f = 0; f < 100; ++f) {
        most = std::max(most, simulation.advance(still(1e-3 * f), still(1e-3 * (f + 1))).contact);
    }
    CHECK(most > 0);
    double apart = 0;
    for (std::size_t p = 0; p < block.particle_count(); ++p) {
        const double way = block.particle_reference.at(p).x() > 0.05 ? 1 : -1;
        apart += way * block.particle_velocity.at(p).x();
    }
    CHECK(apart > 0);
}
