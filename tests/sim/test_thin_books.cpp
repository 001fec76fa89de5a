// SPDX-License-Identifier: GPL-3.0-or-later
// The books of pieces without a whole cell that a blade splits while they press on each other.
#include "sim/advance.h"
#include "sim/thin_piece.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/kinetic_energy.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("what springs hold between thin slices is not lost when a blade splits one of them",
          "[stress]") {
    constexpr double kCell = 0.1;
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    const auto [frame_of_cut, is_alone] =
        GENERATE(table<int, bool>({{8, true}, {10, true}, {12, true}, {10, false}}));
    CAPTURE(frame_of_cut, is_alone);
    Aggregate cube = make_block(6, 8, 6, kCell, kSpringy);
    for (double place : {-0.25, 0.25, 1.25, 2.25}) {
        sever_plane(cube, Vec3(0, place * kCell, 0), Vec3::UnitY());
    }
    const Pieces pieces = find_pieces(cube);
    REQUIRE(thin_pieces(cube).size() == 3);
    // The middle one is struck from both sides, and what is left of the cube is far off.
    for (std::size_t p = 0; p < cube.particle_count(); ++p) {
        const int piece = pieces.particle_piece[p];
        const int from_middle = piece - 2;
        if (std::abs(from_middle) == 2) {
            cube.particle_position.add(p, Vec3(0, 1.5 * from_middle, 0));
        } else {
            cube.particle_position.add(p, Vec3(0, 0.01 * from_middle, 0));
            cube.particle_velocity.set(p, Vec3(0, -2 * from_middle, 0));
        }
    }
    SimSettings settings = motion_settings(solver);
    settings.self_contact = true;
    settings.step_safety = 0.2;
    Apparatus cutter;
    cutter.blade.emplace_back().edge = {Vec3(0.013, 0, -5), Vec3(0.013, 0, 5)};
    // The upper slice lies at 0.2 m, the middle one at 0.1 m.
    const auto at = [last = frame_of_cut](int frame) {
        Drive drive = still(0.001 * frame);
        const double height = frame > last ? 1 : 0.15;
        drive.world_from_blade.push_back({Quat::Identity(), Vec3(0, height, 0)});
        return drive;
    };
    // Another body, out of reach, takes its steps of energy before.
    Aggregate other = make_block(2, 2, 2, kCell, kSpringy);
    place(other, {Quat::Identity(), Vec3(50, 0, 0)});
    std::vector<Aggregate*> bodies = {&other, &cube};
    if (is_alone) bodies.erase(bodies.begin());
    Simulation simulation(bodies, cutter, settings);
    const double kinetic = kinetic_energy(cube);
    FrameReport r;
    double held = 0;
    for (int f = 0; f < 40; ++f) {
        r = simulation.advance(at(f), at(f + 1));
        if (f == frame_of_cut - 1) held = r.contact;
    }
    REQUIRE(thin_pieces(cube).size() == 4);
    INFO("held " << held << ", remainder " << r.remainder << " of " << kinetic);
    CHECK(held > 0.05 * kinetic);
    CHECK(std::abs(r.remainder) < 0.002 * kinetic);
}
