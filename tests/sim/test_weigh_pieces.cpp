// SPDX-License-Identifier: GPL-3.0-or-later
// The mass of what a blade parts.
#include "sim/weigh_pieces.h"

#include "matter/piece_shares.h"
#include "sim/advance.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kA = 0.1;  // a cell

// A wide blade goes along a plane, in so many frames.
double cut(Aggregate& m, const Vec3& point, const Vec3& normal, int frames = 1) {
    const Quat world_from_plane = turn_onto(Vec3::UnitX(), normal.normalized());
    const Blade blade{"blade", {Vec3(0, -3, 0), Vec3(0, 3, 0)}, {}};
    const auto pose = [&](int n) {
        return Pose{world_from_plane, point + world_from_plane * Vec3(0, 0, 6.0 * n / frames - 3)};
    };
    double lost = 0;
    for (int n = 0; n < frames; ++n) {
        const auto events = crossed_connections(m, swept_triangles(blade, pose(n), pose(n + 1)));
        sever(m, events);
        lost += weigh_pieces(m, events);
    }
    return lost;  // [J]
}

std::vector<double> pieces_of(const Aggregate& m) {
    const Pieces pieces = find_pieces(m);
    std::vector<double> mass(std::size_t(pieces.count), 0.0);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        mass[std::size_t(pieces.particle_piece[p])] += m.particle_mass[p];
    }
    return mass;
}

std::vector<Vec3> centres_of(const Aggregate& m) {
    const Pieces pieces = find_pieces(m);
    std::vector<Vec3> moment(std::size_t(pieces.count), Vec3::Zero());
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        moment[std::size_t(pieces.particle_piece[p])] +=
            m.particle_mass[p] * m.particle_position.at(p);
    }
    const std::vector<double> mass = pieces_of(m);
    for (std::size_t n = 0; n < moment.size(); ++n) moment[n] /= mass[n];
    return moment;
}

Vec3 momentum_of(const Aggregate& m) { return m.mass() * m.mean_velocity(); }

Vec3 spin_of(const Aggregate& m) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 arm = m.particle_position.at(p) - m.centre();
        sum += m.particle_mass[p] * arm.cross(m.particle_velocity.at(p) - m.mean_velocity());
    }
    return sum;
}

// Of a box about the origin what lies below the plane [m3].
double volume_below(const Vec3& half, const Vec3& point, const Vec3& normal) {
    const Vec3 size = 2 * half;
    return size.prod() * share_of_cube(size.cwiseProduct(normal), normal.dot(point));
}

}  // namespace

TEST_CASE("the share of a cube below a plane is what points in it say") {
    for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(1, 0, -1), Vec3(1, 1, 1), Vec3(0.2, -0.9, 0.5),
                               Vec3(1e-7, 1, 0.3), Vec3(-3, 0.1, 0.2)}) {
        for (double at : {-0.9, -0.45, -0.2, 0.0, 0.13, 0.31, 0.49, 0.8}) {
            const double distance = at * normal.cwiseAbs().sum() / 1.7;
            constexpr int kFine = 60;
            int below = 0;
            for (int n = 0; n < kFine * kFine * kFine; ++n) {
                const Vec3 x =
                    (Vec3(n % kFine, n / kFine % kFine, n / kFine / kFine) + Vec3::Constant(0.5)) /
                        kFine -
                    Vec3::Constant(0.5);
                below += normal.dot(x) < distance;
            }
            CAPTURE(normal.transpose(), at);
            CHECK(share_of_cube(normal, distance) ==
                  Approx(below / double(kFine * kFine * kFine)).margin(0.009));
            CHECK(share_of_cube(-normal, -distance) ==
                  Approx(1 - share_of_cube(normal, distance)).margin(1e-12));
        }
    }
}

TEST_CASE("a piece has the mass of what lies on its side of the blade") {
    const Vec3 normal = GENERATE(Vec3(0, 1, 0), Vec3(0.36, 1, 0), Vec3(1, 1, 0), Vec3(1, -1, 1),
                                 Vec3(0.3, -0.8, 0.5))
                            .normalized();
    const double off = GENERATE(-2.4, -0.5, -0.05, 0.0, 0.05, 0.45, 0.95, 2.3, 3.4);
    const int frames = GENERATE(1, 5);
    CAPTURE(normal.transpose(), off, frames);
    Aggregate block = make_block(8, 8, 8, kA, kSpringy);
    const double mass = block.mass(), density = kSpringy.density;
    const Vec3 at = off * kA * normal;
    cut(block, at, normal, frames);
    const std::vector<double> piece = pieces_of(block);
    REQUIRE(piece.size() == 2);
    CHECK(block.mass() == Approx(mass).epsilon(1e-13));
    const double below = density * volume_below(Vec3::Constant(4 * kA), at, normal);
    const bool first_is_below = normal.dot(block.particle_reference.at(0) - at) < 0;
    const double own = piece[first_is_below ? 0 : 1], other = piece[first_is_below ? 1 : 0];
    CHECK(own == Approx(below).epsilon(1e-5));
    CHECK(other == Approx(mass - below).epsilon(1e-5));
    // Of slabs of more than a layer of particles the middle too.
    if (normal.y() != 1 || std::abs(off) > 3) return;
    const std::vector<Vec3> centre = centres_of(block);
    CHECK((centre[0] - Vec3(0, (off / 2 - 2) * kA, 0)).norm() < 0.02 * kA);
    CHECK((centre[1] - Vec3(0, (off / 2 + 2) * kA, 0)).norm() < 0.02 * kA);
}

TEST_CASE("what a blade gives to the other side takes its momentum along") {
    const int frames = GENERATE(1, 7);
    Aggregate block = make_block(8, 8, 8, kA, kSpringy);
    const Vec3 spin(3, -20, 7), speed(5, 1, -2);
    for (std::size_t p = 0; p < block.particle_count(); ++p) {
        const Vec3 x = block.particle_position.at(p);
        const Vec3 swing(std::sin(40 * x.y()), std::cos(30 * x.z()), std::sin(50 * x.x()));
        block.particle_velocity.set(p, speed + spin.cross(x) + 0.3 * swing);
    }
    const Vec3 momentum = momentum_of(block), turns = spin_of(block);
    const double mass = block.mass(), energy = kinetic_energy(block);
    const double lost = cut(block, Vec3(0.013, 0.037, 0), Vec3(0.2, 1, 0.1), frames);
    REQUIRE(pieces_of(block).size() == 2);
    CHECK(block.mass() == Approx(mass).epsilon(1e-12));
    CHECK((momentum_of(block) - momentum).norm() < 1e-12 * momentum.norm());
    CHECK((spin_of(block) - turns).norm() < 1e-12 * turns.norm());
    CHECK(energy - kinetic_energy(block) == Approx(lost).epsilon(1e-9));
    CHECK(std::abs(lost) < 0.02 * energy);
    // Where it only flies nothing is slowed.
    Aggregate flying = make_block(8, 8, 8, kA, kSpringy);
    for (std::size_t p = 0; p < flying.particle_count(); ++p) {
        flying.particle_velocity.set(p, speed);
    }
    CHECK(std::abs(cut(flying, Vec3(0, 0.04, 0), Vec3::UnitY(), frames)) <
          1e-12 * kinetic_energy(flying));
}

TEST_CASE("where blades cross each other every piece has what lies there") {
    Aggregate block = make_block(8, 8, 8, kA, kSpringy);
    const double mass = block.mass(), x = 0.03, y = -0.12;
    cut(block, Vec3(x, 0, 0), Vec3::UnitX());
    cut(block, Vec3(0, y, 0), Vec3::UnitY());
    const std::vector<double> piece = pieces_of(block);
    REQUIRE(piece.size() == 4);
    const double half = 4 * kA, whole = 4 * half * half;
    // By their first particles, along x and then y.
    CHECK(piece[0] == Approx(mass * (half + x) * (half + y) / whole).epsilon(1e-3));
    CHECK(piece[1] == Approx(mass * (half - x) * (half + y) / whole).epsilon(1e-3));
    CHECK(piece[2] == Approx(mass * (half + x) * (half - y) / whole).epsilon(1e-3));
    CHECK(piece[3] == Approx(mass * (half - x) * (half - y) / whole).epsilon(1e-3));
}

TEST_CASE("no piece gets less than a quarter of what its particles had, however thin blades slice") {
    Aggregate block = make_block(8, 8, 8, kA, kSpringy);
    const double mass = block.mass();
    const std::vector<double> before = block.particle_mass;
    const double y = GENERATE(-0.01, 0.3, 3.999);
    cut(block, Vec3(0, y * kA, 0), Vec3::UnitY());
    cut(block, Vec3(0, (y - 0.02) * kA, 0), Vec3::UnitY());
    cut(block, Vec3(0.999 * kA, 0, 0), Vec3::UnitX());
    cut(block, Vec3(1.001 * kA, 0, 0), Vec3::UnitX());
    CAPTURE(y);
    CHECK(block.mass() == Approx(mass).epsilon(1e-12));
    const std::vector<double> piece = pieces_of(block);
    const Pieces pieces = find_pieces(block);
    std::vector<double> had(piece.size(), 0.0);
    for (std::size_t p = 0; p < before.size(); ++p) {
        had[std::size_t(pieces.particle_piece[p])] += before[p];
        CHECK(block.particle_mass[p] > 0.09 * before[p]);  // a sixth of a blade's thinnest, twice
    }
    for (std::size_t n = 0; n < piece.size(); ++n) CHECK(piece[n] > 0.249 * had[n]);
}

TEST_CASE("matter that only falls on is parted without work, and by its weight") {
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    Aggregate block = make_block(4, 4, 4, kA, kSpringy);
    Apparatus apparatus;
    apparatus.name = "cut";
    apparatus.blade.push_back({"blade", {Vec3(-1, 0.04, 0), Vec3(1, 0.04, 0)}, {}});
    SimSettings settings = motion_settings(solver);
    settings.gravity = Vec3(0, -10, 0);
    Simulation simulation(block, apparatus, settings);
    const auto drive = [](double time, double z) {
        Drive d = still(time);
        d.world_from_blade = {Pose{Quat::Identity(), Vec3(0, 0, z)}};
        return d;
    };
    const double mass = block.mass();
    FrameReport r;
    for (int n = 0; n < 4; ++n) {
        r = simulation.advance(drive(0.01 * n, 0.5 - 0.25 * n),
                               drive(0.01 * (n + 1), 0.25 - 0.25 * n));
    }
    REQUIRE(r.pieces == 2);
    const std::vector<double> piece = pieces_of(block);
    CHECK(piece[0] / mass == Approx(0.6).epsilon(0.01));  // the blade has no way along y
    const double fallen = 0.5 * 10 * 0.04 * 0.04;
    CHECK(r.gravity_work == Approx(mass * 10 * fallen).epsilon(1e-3));
    CHECK(std::abs(r.remainder) < 1e-3 * r.gravity_work);
}
