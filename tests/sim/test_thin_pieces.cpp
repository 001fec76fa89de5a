// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces in which blades have left no whole cell: they meet each other, tools and all else.
#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "sim/advance.h"
#include "sim/thin_piece.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/kinetic_energy.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kCell = 0.1;

Material rubber() {
    return {.young_modulus = 1e6, .poisson_ratio = 0.25, .density = 1000, .damping_ratio = 0.05};
}

// A cube, cut across y at these places [cells].
Aggregate sliced(int cells, const std::vector<double>& places) {
    Aggregate cube = make_block(cells, cells, cells, kCell, rubber());
    for (double place : places) sever_plane(cube, Vec3(0, place * kCell, 0), Vec3::UnitY());
    REQUIRE(find_pieces(cube).count == int(places.size()) + 1);
    return cube;
}

struct Slice {
    double place = 0, low = 1e9, high = -1e9;  // mean, lowest and highest of its particles
    Vec3 momentum = Vec3::Zero();
};

Slice slice_of(const Aggregate& matter, const Pieces& pieces, int piece) {
    Slice slice;
    double mass = 0;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        if (pieces.particle_piece[p] != piece) continue;
        const double m = matter.particle_mass[p], y = matter.particle_position.y[p];
        slice.place += m * y;
        slice.momentum += m * matter.particle_velocity.at(p);
        slice.low = std::min(slice.low, y);
        slice.high = std::max(slice.high, y);
        mass += m;
    }
    slice.place /= mass;
    return slice;
}

void move(Aggregate& matter, const Pieces& pieces, int piece, const Vec3& way, const Vec3& speed) {
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        if (pieces.particle_piece[p] != piece) continue;
        matter.particle_position.add(p, way);
        matter.particle_velocity.set(p, speed);
    }
}

}  // namespace

namespace {

// Two slices of a cube, a layer of particles each, fall onto one another on a floor. The
// lower is 0.1 m above it, the other 0.1 m above that, the rest of the cube beside them.
void fall_on_each_other(int cells, double shift, Solver solver, int frames) {
    Aggregate cube = sliced(cells, {-0.5 + shift, 0.5 + shift, 1.5 + shift});
    const Pieces pieces = find_pieces(cube);
    const double lower = slice_of(cube, pieces, 1).place, upper = slice_of(cube, pieces, 2).place;
    const double above = lower - (-0.5 + shift) * kCell;  // the blade's path: its particles
    move(cube, pieces, 0, Vec3(2, 0.31, 0), Vec3::Zero());
    move(cube, pieces, 1, Vec3(0, 0.15 - lower, 0), Vec3::Zero());
    move(cube, pieces, 2, Vec3(0.02, 0.35 - upper, 0.01), Vec3::Zero());
    move(cube, pieces, 3, Vec3(-2, 0, 0), Vec3::Zero());
    SimSettings settings = motion_settings(solver);
    settings.self_contact = true;
    settings.step_safety = 0.2;  // the books' remainder is of second order in it
    settings.gravity = Vec3(0, -9.81, 0);
    const Apparatus floor = floor_with(0.3);
    Simulation simulation(cube, floor, settings);
    FrameReport r;
    double nearest = 1, lowest = 1;
    for (int f = 0; f < frames; ++f) {
        r = simulation.advance(floor_at(0.02 * f), floor_at(0.02 * (f + 1)));
        const Slice low = slice_of(cube, pieces, 1), high = slice_of(cube, pieces, 2);
        nearest = std::min(nearest, high.place - low.place);
        lowest = std::min(lowest, low.low);
    }
    const Slice low = slice_of(cube, pieces, 1), high = slice_of(cube, pieces, 2);
    INFO("lower " << low.place << " (" << low.low << " to " << low.high << "), upper " << high.place
                  << " (" << high.low << " to " << high.high << "), nearest " << nearest
                  << ", lowest " << lowest << ", remainder " << r.remainder << " of "
                  << r.gravity_work);
    CHECK(high.place - low.place == Approx(kCell).margin(0.05 * kCell));
    CHECK(low.place == Approx(above).margin(0.05 * kCell));
    CHECK(nearest > 0.5 * kCell);
    CHECK(lowest - above > -0.25 * kCell);
    CHECK(std::abs(r.remainder) < 0.01 * r.gravity_work);
}

}  // namespace

TEST_CASE("of two slices without a whole cell that fall on each other one rests on the other",
          "[stress]") {
    const double shift = GENERATE(0., 0.25, 0.5, 0.75);
    CAPTURE(shift);
    fall_on_each_other(6, shift, Solver::explicit_steps, 50);
}

TEST_CASE("slices without a whole cell rest on each other by steps of energy too", "[stress]") {
    fall_on_each_other(4, 0.25, Solver::energy_stepped, 25);
}

namespace {

struct Motion {
    Vec3 momentum = Vec3::Zero(), spin = Vec3::Zero();  // about the origin
};

Motion motion_of(const Aggregate& matter) {
    Motion all;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const Vec3 push = matter.particle_mass[p] * matter.particle_velocity.at(p);
        all.momentum += push;
        all.spin += matter.particle_position.at(p).cross(push);
    }
    return all;
}

}  // namespace

TEST_CASE("a slice without a whole cell that is thrown at another pushes it on", "[stress]") {
    const double turned = GENERATE(0., 0.2);
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    CAPTURE(turned);
    Aggregate cube = sliced(6, {-0.25, 0.25, 1.25});  // the first is half a cell thick
    const Pieces pieces = find_pieces(cube);
    move(cube, pieces, 0, Vec3(0, -1, 0), Vec3::Zero());
    move(cube, pieces, 3, Vec3(0, 1, 0), Vec3::Zero());
    const Vec3 speed(0.5, 2, 0);
    move(cube, pieces, 1, Vec3(0.03, -0.15, 0.02), speed);
    const Mat3 turn = Eigen::AngleAxisd(turned, Vec3(1, 0, 2).normalized()).toRotationMatrix();
    const Vec3 middle(0.03, -0.15, 0.02);
    for (std::size_t p = 0; p < cube.particle_count(); ++p) {
        if (pieces.particle_piece[p] != 1) continue;
        cube.particle_position.set(p, middle + turn * (cube.particle_position.at(p) - middle));
    }
    SimSettings settings = motion_settings(solver);
    settings.self_contact = true;
    const Apparatus nothing;
    Simulation simulation(cube, nothing, settings);
    const Motion before = motion_of(cube);
    const double kinetic = kinetic_energy(cube);
    FrameReport r;
    double nearest = 1;
    for (int f = 0; f < 30; ++f) {
        r = simulation.advance(still(0.01 * f), still(0.01 * (f + 1)));
        nearest =
            std::min(nearest, slice_of(cube, pieces, 2).place - slice_of(cube, pieces, 1).place);
    }
    const Motion after = motion_of(cube);
    const Slice thrown = slice_of(cube, pieces, 1), struck = slice_of(cube, pieces, 2);
    INFO("thrown " << thrown.momentum.transpose() << ", struck " << struck.momentum.transpose()
                   << ", nearest " << nearest << ", remainder " << r.remainder << " of "
                   << kinetic);
    CHECK((after.momentum - before.momentum).norm() < 1e-9 * before.momentum.norm());
    CHECK((after.spin - before.spin).norm() < 1e-3 * before.spin.norm());
    CHECK(struck.momentum.y() > 0.5 * before.momentum.y());
    CHECK(nearest > 0.5 * kCell);
    CHECK(std::abs(r.remainder) < 0.01 * kinetic);
}

TEST_CASE("slices without a whole cell lie still where they were cut") {
    for (const double shift : {0., 0.25, 0.5, 0.75}) {
        Aggregate cube = sliced(4, {-1.5 + shift, -0.5 + shift, 0.5 + shift});
        SimSettings settings = motion_settings();
        settings.self_contact = true;
        const Apparatus nothing;
        Simulation simulation(cube, nothing, settings);
        for (int f = 0; f < 4; ++f) {
            simulation.advance(still(0.02 * f), still(0.02 * (f + 1)));
        }
        CAPTURE(shift, largest_stretch(cube));
        CHECK(kinetic_energy(cube) < 1e-12);
    }
}

TEST_CASE("slices without a whole cell go on by the same bits from where they were kept") {
    const Aggregate uncut = make_block(4, 4, 4, kCell, rubber());
    Aggregate cube = sliced(4, {-0.5, 0.5, 1.5});
    const Pieces pieces = find_pieces(cube);
    move(cube, pieces, 2, Vec3(0.02, 0.1, 0), Vec3(0, -2, 0));
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    settings.gravity = Vec3(0, -9.81, 0);
    const Apparatus floor = floor_with(0.3);
    const auto at = [](int frame) {
        Drive drive = floor_at(0.01 * frame);
        drive.world_from_tool[0].translation.y() -= 0.21;
        return drive;
    };
    Simulation simulation(cube, floor, settings);
    for (int f = 0; f < 8; ++f) simulation.advance(at(f), at(f + 1));
    ByteWriter kept;
    simulation.save(kept);
    Aggregate again = uncut;  // as the stage began, before the cut
    Simulation other(again, floor, settings);
    again = cube;
    ByteReader in(kept.bytes());
    other.load(in);
    for (int f = 8; f < 16; ++f) {
        simulation.advance(at(f), at(f + 1));
        other.advance(at(f), at(f + 1));
    }
    CHECK(state_hash(again) == state_hash(cube));
}

TEST_CASE("slices without a whole cell that were cut aslant push each other on too") {
    const double angle = GENERATE(0.2, 0.45, 0.7);
    CAPTURE(angle);
    const Vec3 normal(std::cos(angle), std::sin(angle), 0);
    Aggregate cube = make_block(8, 8, 4, kCell, rubber());
    for (double place : {-1.1, 0., 1.1}) sever_plane(cube, place * kCell * normal, normal);
    const Pieces pieces = find_pieces(cube);
    REQUIRE(pieces.count == 4);
    REQUIRE(thin_pieces(cube).size() == 2);
    const auto piece_at = [&](double place) {
        for (std::size_t p = 0; p < cube.particle_count(); ++p) {
            const double at = cube.particle_reference.at(p).dot(normal) / kCell;
            if (at > place && at < place + 1.1) return pieces.particle_piece[p];
        }
        return -1;
    };
    const int thrown = piece_at(-1.1), struck = piece_at(0);
    for (int piece = 0; piece < 4; ++piece) {
        const bool is_far = piece != thrown && piece != struck;
        move(cube, pieces, piece, is_far ? Vec3(0, 0, 5. + piece) : Vec3(Vec3::Zero()),
             Vec3::Zero());
    }
    move(cube, pieces, thrown, -0.05 * normal, 2 * normal);
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    settings.step_safety = 0.2;
    const Apparatus nothing;
    Simulation simulation(cube, nothing, settings);
    const Motion before = motion_of(cube);
    const double kinetic = kinetic_energy(cube);
    FrameReport r;
    for (int f = 0; f < 20; ++f) r = simulation.advance(still(0.01 * f), still(0.01 * (f + 1)));
    const Motion after = motion_of(cube);
    double gap = 0;  // between their middles
    for (int piece : {thrown, struck}) {
        Vec3 sum = Vec3::Zero();
        double mass = 0;
        for (std::size_t p = 0; p < cube.particle_count(); ++p) {
            if (pieces.particle_piece[p] != piece) continue;
            sum += cube.particle_mass[p] * cube.particle_position.at(p);
            mass += cube.particle_mass[p];
        }
        gap += (piece == struck ? 1 : -1) * normal.dot(sum) / mass;
    }
    const Vec3 pushed = slice_of(cube, pieces, struck).momentum;
    INFO("struck " << pushed.dot(normal) << " of " << before.momentum.dot(normal) << ", gap " << gap
                   << ", remainder " << r.remainder << " of " << kinetic);
    CHECK((after.momentum - before.momentum).norm() < 1e-9 * before.momentum.norm());
    CHECK((after.spin - before.spin).norm() < 1e-3 * before.momentum.norm());
    CHECK(pushed.dot(normal) > 0.5 * before.momentum.dot(normal));
    CHECK(gap > kCell);
    CHECK(std::abs(r.remainder) < 0.01 * kinetic);
}

// As equilibria leave them, in which their particles alone meet tools and whole cells.
TEST_CASE("slices without a whole cell that begin deep in a floor and in each other stay so") {
    Aggregate cube = sliced(4, {-0.5, 0.5, 1.5});
    const Pieces pieces = find_pieces(cube);
    move(cube, pieces, 0, Vec3(0, -5, 0), Vec3::Zero());
    move(cube, pieces, 2, Vec3(0, -0.06, 0), Vec3::Zero());
    move(cube, pieces, 3, Vec3(0, 5, 0), Vec3::Zero());
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    settings.gravity = Vec3(0, -9.81, 0);
    const Apparatus floor = floor_with(0.3);
    Simulation simulation(cube, floor, settings);
    for (int f = 0; f < 10; ++f) simulation.advance(floor_at(0.01 * f), floor_at(0.01 * (f + 1)));
    for (int piece : {1, 2}) {
        const Slice slice = slice_of(cube, pieces, piece);
        CHECK(slice.place == Approx(piece == 1 ? 0 : 0.04).margin(0.02 * kCell));
        CHECK(slice.momentum.norm() < 0.1);
    }
}

TEST_CASE("upright slices without a whole cell fall in on themselves and keep their books") {
    Material sponge = rubber();
    sponge.young_modulus = 2e4;
    Aggregate cube = make_block(6, 8, 6, kCell, sponge);
    for (double place : {-1.5, -0.5, 0.5, 1.5}) {
        sever_plane(cube, Vec3(place * kCell, 0, 0), Vec3(1, 0.02, 0).normalized());
    }
    REQUIRE(thin_pieces(cube).size() == 3);
    for (std::size_t p = 0; p < cube.particle_count(); ++p) {
        const Vec3 at = cube.particle_position.at(p);
        cube.particle_position.set(p, at + Vec3(0.03 * at.y(), 0.6, 0));
    }
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    settings.step_safety = 0.4;
    settings.gravity = Vec3(0, -9.81, 0);
    const Apparatus floor = floor_with(0.3);
    Simulation simulation(cube, floor, settings);
    FrameReport r;
    for (int f = 0; f < 60; ++f) {
        r = simulation.advance(floor_at(0.02 * f), floor_at(0.02 * (f + 1)));
    }
    INFO("remainder " << r.remainder << " of " << r.gravity_work);
    CHECK(std::abs(r.remainder) < 0.01 * r.gravity_work);
}

// Nothing but contact could hold it.
TEST_CASE("a slice without a whole cell flies off what it was cut from, however thin it is") {
    const double thickness = GENERATE(0.05, 0.1, 0.15, 0.3, 0.5, 0.7, 0.95);
    const double angle = GENERATE(0., 0.05);
    CAPTURE(thickness, angle);
    if (angle > 0 && std::abs(thickness - 0.5) > 0.25) return;  // a wedge, or two layers
    Aggregate cube = make_block(6, 6, 6, kCell, rubber());
    const Vec3 normal(std::sin(angle), std::cos(angle), 0);
    sever_plane(cube, Vec3(0, (3 - thickness) * kCell, 0), normal);
    const Pieces pieces = find_pieces(cube);
    REQUIRE(pieces.count == 2);
    REQUIRE(thin_pieces(cube).size() == 1);
    const double place = slice_of(cube, pieces, 1).place;
    move(cube, pieces, 1, Vec3::Zero(), 0.2 * normal);
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    const Apparatus nothing;
    Simulation simulation(cube, nothing, settings);
    for (int f = 0; f < 4; ++f) simulation.advance(still(0.01 * f), still(0.01 * (f + 1)));
    CHECK(slice_of(cube, pieces, 1).place - place == Approx(0.04 * 0.2 * normal.y()).epsilon(0.01));
}

TEST_CASE("a stack of slices, some without a whole cell, stays as high as it was cut", "[stress]") {
    // Where the blades went, of a cube from -3 to 3.
    const std::vector<double> places =
        GENERATE(std::vector<double>{-2.05}, std::vector<double>{-1.8, -0.8},
                 std::vector<double>{-1.5, -0.65, 0.9}, std::vector<double>{-2.3, -1.35, -0.35},
                 std::vector<double>{-0.9, 0.8});
    INFO("first " << places[0] << " of " << places.size());
    Material firm = rubber();
    firm.young_modulus = 1e7;
    Aggregate cube = make_block(6, 6, 6, kCell, firm);
    for (double place : places) sever_plane(cube, Vec3(0, place * kCell, 0), Vec3::UnitY());
    const Pieces pieces = find_pieces(cube);
    REQUIRE(pieces.count == int(places.size()) + 1);
    REQUIRE(!thin_pieces(cube).empty());
    for (int piece = 0; piece < pieces.count; ++piece) {
        move(cube, pieces, piece, Vec3(0, 0.3, 0), Vec3::Zero());
    }
    std::vector<Slice> before;
    for (int n = 0; n < pieces.count; ++n) before.push_back(slice_of(cube, pieces, n));
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    settings.gravity = Vec3(0, -9.81, 0);
    const Apparatus floor = floor_with(0.5);
    Simulation simulation(cube, floor, settings);
    for (int f = 0; f < 20; ++f) simulation.advance(floor_at(0.02 * f), floor_at(0.02 * (f + 1)));
    for (int n = 0; n < pieces.count; ++n) {
        const Slice slice = slice_of(cube, pieces, n);
        CAPTURE(n);
        CHECK(slice.place == Approx(before[std::size_t(n)].place).margin(0.05 * kCell));
        CHECK(slice.low == Approx(before[std::size_t(n)].low).margin(0.1 * kCell));
        CHECK(slice.high == Approx(before[std::size_t(n)].high).margin(0.1 * kCell));
    }
}

TEST_CASE("corners without a surface of their own that a blade parts do not fall through a floor") {
    // Half of the ball's lowest cells is empty: below the blade there is no surface at all.
    Aggregate ball = make_shape([](const Vec3& x) { return x.norm() - 4.5 * kCell; },
                                Vec3::Constant(-5 * kCell), Vec3i(10, 10, 10), kCell);
    ball.material = rubber();
    sever_plane(ball, Vec3(0, -4.97 * kCell, 0), Vec3::UnitY());
    const Pieces pieces = find_pieces(ball);
    REQUIRE(pieces.count == 2);
    for (std::size_t p = 0; p < ball.particle_count(); ++p) {
        ball.particle_position.add(p, Vec3(0, 4.6 * kCell, 0));
    }
    SimSettings settings = motion_settings();
    settings.gravity = Vec3(0, -9.81, 0);
    settings.self_contact = true;
    const Apparatus floor = floor_with(0.3);
    Simulation simulation(ball, floor, settings);
    for (int frame = 0; frame < 10; ++frame) {
        simulation.advance(floor_at(0.02 * frame), floor_at(0.02 * (frame + 1)));
    }
    double low = 1;
    for (std::size_t p = 0; p < ball.particle_count(); ++p) {
        low = std::min(low, ball.particle_position.at(p).y());
    }
    CHECK(low > -kCell);  // fallen freely it is at -2 cells
}
