// SPDX-License-Identifier: GPL-3.0-or-later
// Faces that a blade has laid open, however it stood to the lattice.
#include "sim/contact_side.h"
#include "sim/sever.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/loads_fixture.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kA = 0.1;  // a cell

}  // namespace

TEST_CASE("a cut is where the blade went: its points lie there, and depth is told from there") {
    const Vec3 normal = GENERATE(Vec3(0, 1, 0), Vec3(0.09, 1, 0), Vec3(0.36, 1, 0), Vec3(1, 1, 0),
                                 Vec3(1.7, 1, 0), Vec3(0.3, 0.8, 0.5), Vec3(1, -1, 1))
                            .normalized();
    const double off = GENERATE(-0.3, 0.05, 0.4);
    CAPTURE(normal.transpose(), off);
    Aggregate block = make_block(10, 10, 10, kA, kSpringy);
    const Vec3 at = off * kA * normal;
    sever_plane(block, at, normal);
    ContactSide side(block, true, nullptr);
    const auto beyond = [&](const Vec3& x) { return normal.dot(x - at) / kA; };
    const auto is_inner = [](const Vec3& x) { return x.cwiseAbs().maxCoeff() < 3 * kA; };
    double area[2] = {};
    int points = 0;
    for (std::size_t p = side.own_points(); p < side.points().size(); ++p) {
        if (!side.meets(int(p)) || side.is_loose(int(p))) continue;
        const Vec3 x = side.points().reference(p, block.particle_reference);
        CHECK(std::abs(beyond(x)) < 1e-5);
        const double faces = side.points().normal(p).dot(normal);
        CHECK(std::abs(faces) > 1 - 1e-6);
        if (is_inner(x)) area[faces > 0] += side.points().area(p) / (kA * kA), ++points;
    }
    CHECK(points > 20);
    // Of the plane what lies within the same box: by its samples, a tenth of a cell apart.
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    double section = 0;
    for (int i = -50; i <= 50; ++i) {
        for (int j = -50; j <= 50; ++j) {
            section += is_inner(at + 0.1 * kA * (i * u + j * v)) ? 0.01 : 0;
        }
    }
    CHECK(area[0] == Approx(section).epsilon(0.2));
    CHECK(area[1] == Approx(section).epsilon(0.2));
    // And how deep places lie, in whole cells and before them.
    int places = 0;
    for (CellId cell : side.rim()) {
        if (!side.is_whole(cell)) continue;
        const Vec3i site = block.lattice.cell_site(cell);
        for (int n = 0; n < 27; ++n) {
            const Vec3 place = 0.6 * Vec3(n % 3, n / 3 % 3, n / 9) - Vec3::Constant(0.1);
            const Vec3 x = block.lattice.origin + kA * (site.cast<double>() + place);
            const Vec3 middle =
                block.lattice.origin + kA * (site.cast<double>() + Vec3::Constant(0.5));
            const double far = beyond(x) * (beyond(middle) < 0 ? 1 : -1);
            if (!is_inner(x) || far < -0.7) continue;
            CHECK(side.depth(site, cell, place).distance == Approx(far).margin(1e-3));
            ++places;
        }
    }
    CHECK(places > 100);
}

TEST_CASE("a piece slides down an oblique cut as on a smooth plane") {
    const double slope = GENERATE(0.1, 0.3, 0.6, 1.0);  // [rad]
    CAPTURE(slope);
    Material matter = kSpringy;
    matter.young_modulus = 1e7;
    matter.damping_ratio = 0.1;
    matter.friction = 0;
    Aggregate block = make_block(14, 14, 6, kA, matter);
    const Vec3 normal(std::sin(slope), std::cos(slope), 0),
        down(std::cos(slope), -std::sin(slope), 0);
    sever_plane(block, 0.13 * kA * normal, normal);
    const Pieces pieces = find_pieces(block);
    REQUIRE(pieces.count == 2);
    Apparatus apparatus;
    apparatus.grip.push_back(hold(block, points_where(block, [&](const Vec3& x) {
                                      return std::min(x.x(), x.y()) < -0.69 &&
                                             normal.dot(x) < -0.05;
                                  })));
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    settings.gravity = Vec3(0, -9.81, 0);
    Simulation simulation(block, apparatus, settings);
    const int upper = pieces.particle_piece[std::size_t(block.particle_count()) - 1];
    const auto middle = [&] {
        Vec3 sum = Vec3::Zero();
        double mass = 0;
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            if (pieces.particle_piece[p] != upper) continue;
            sum += block.particle_mass[p] * block.particle_position.at(p);
            mass += block.particle_mass[p];
        }
        return Vec3(sum / mass);
    };
    const Vec3 before = middle();
    FrameReport report;
    for (int f = 0; f < 10; ++f) {
        report = simulation.advance(drive_of(apparatus, 0.02 * f, 1),
                                    drive_of(apparatus, 0.02 * (f + 1), 1));
    }
    const Vec3 way = middle() - before;
    const double expected = 0.5 * 9.81 * std::sin(slope) * 0.2 * 0.2;
    CHECK(way.dot(down) == Approx(expected).epsilon(0.05));
    CHECK(std::abs(way.dot(normal)) < 0.1 * kA);
    CHECK(std::abs(report.remainder) < 0.01 * report.gravity_work);
}

namespace {

// A blade falls through the block along y; its path stands across x, before it is turned.
void chop(Aggregate& block, const Quat& turn, double place) {
    Blade blade;
    blade.edge = {Vec3(0, 0, -20 * kA), Vec3(0, 0, 20 * kA)};
    const auto at = [&](double height) {
        return Pose{turn, turn * Vec3(place * kA, height * kA, 0)};
    };
    sever(block, crossed_connections(block, swept_triangles(blade, at(20), at(-20))));
}

void chop_all(Aggregate& block, const Quat& turn, double pitch) {
    for (double place = -5.35; place < 6; place += pitch) chop(block, turn, place);
}

// Of new surface, by the axis that it looks along most [cells].
std::array<double, 3> new_area(Aggregate& block) {
    const ContactSide side(block, true, nullptr);
    std::array<double, 3> area{};
    for (std::size_t p = side.own_points(); p < side.points().size(); ++p) {
        if (!side.meets(int(p)) || side.is_loose(int(p))) continue;
        Eigen::Index axis;
        side.points().normal(p).cwiseAbs().maxCoeff(&axis);
        area[std::size_t(axis)] += side.points().area(p) / (kA * kA);
    }
    return area;
}

}  // namespace

TEST_CASE("dice keep the area of all their faces, though no blade stands quite square") {
    Aggregate block = make_block(12, 6, 12, kA, kSpringy);
    const std::vector<double> places = {-4.6, -2.4, -0.3, 2.4, 4.6};
    const double off = GENERATE(0., 1e-9, -1e-4, 0.01, -0.02);
    CAPTURE(off);
    const Quat turned(Eigen::AngleAxisd(0.5 * kPi + off, Vec3::UnitY()));
    for (double place : places) chop(block, Quat::Identity(), place);
    for (double place : places) chop(block, turned, place);
    REQUIRE(find_pieces(block).count == 36);
    const std::array<double, 3> area = new_area(block);
    // Two sides of five cuts, and seven whole cells across each way.
    CHECK(area[0] == Approx(2 * 5 * 7 * 6).epsilon(1e-3));
    CHECK(area[1] == 0);
    CHECK(area[2] == Approx(2 * 5 * 7 * 6).epsilon(1e-3));
}

TEST_CASE("a stick cut from a block both ways rests on a face that the first blade cut") {
    const double turn = GENERATE(0., 1e-6, -1e-6, 0.02, -0.02);
    CAPTURE(turn);
    Material matter = kSpringy;
    matter.damping_ratio = 0.1;
    Aggregate block = make_block(6, 8, 8, kA, matter);
    const Vec3 x = Vec3(1, turn, 0).normalized(), y = Vec3(-turn, 1, 0).normalized();
    for (double place : {-1.9, 0.1}) sever_plane(block, place * kA * x, x);
    for (double place : {-2.1, 1.1}) sever_plane(block, place * kA * y, y);
    const Pieces pieces = find_pieces(block);
    REQUIRE(pieces.count == 9);
    const auto is_stick = [&](std::size_t p) {
        const Vec3 at = block.particle_reference.at(p) / kA;
        return at.dot(x) > -1.9 && at.dot(x) < 0.1 && at.dot(y) > -2.1 && at.dot(y) < 1.1;
    };
    int in_stick = 0;
    for (std::size_t p = 0; p < block.particle_count(); ++p) {
        const Vec3 at = block.particle_reference.at(p);
        in_stick += is_stick(p);
        const Vec3 face(-at.dot(y), at.dot(x) + 1.9 * kA + 0.005, at.z());  // its face down
        const Vec3 aside(0, 9.0 + 3 * pieces.particle_piece[p], 0);
        block.particle_position.set(p, is_stick(p) ? face : Vec3(at + aside));
    }
    REQUIRE(in_stick == 2 * 4 * 9);
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    settings.gravity = Vec3(0, -9.81, 0);
    const Apparatus floor = floor_with(0.3);
    Simulation simulation(block, floor, settings);
    for (int f = 0; f < 25; ++f) simulation.advance(floor_at(0.02 * f), floor_at(0.02 * (f + 1)));
    double mean = 0;
    for (std::size_t p = 0; p < block.particle_count(); ++p) {
        if (is_stick(p)) mean += block.particle_position.y[p] / kA / in_stick;
    }
    CHECK(mean == Approx(1.4).margin(0.03));  // between the layers at 0.9 and at 1.9
}

TEST_CASE("of matter that lies turned all cuts are kept as they stand in the shape at molding") {
    const double pitch = GENERATE(3.1, 2.1, 1.6, 1.3, 1.0);
    const bool is_strained = GENERATE(false, true);
    if (is_strained && pitch < 2) return;  // no layer tells what it is across
    CAPTURE(pitch, is_strained);
    Aggregate block = make_block(12, 12, 6, kA, kSpringy);
    const Quat turn(Eigen::AngleAxisd(1, Vec3(0.3, 0.1, 1).normalized()));
    Mat3 map = turn.toRotationMatrix();
    if (is_strained) map *= (Mat3() << 1.1, 0, 0, 0, 0.8, 0, 0, 0, 1.2).finished();
    deform(block, [&](const Vec3& x) { return Vec3(map * x); });
    // Across x, y and z: where it has been cut thin both ways rows of particles are left.
    const Quat onto_y = turn_onto(Vec3::UnitX(), Vec3::UnitY()),
               onto_z = turn_onto(Vec3::UnitX(), Vec3::UnitZ());
    std::size_t before = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const Quat& across = axis == 0 ? Quat::Identity() : axis == 1 ? onto_y : onto_z;
        chop_all(block, turn * across, pitch);
        REQUIRE(block.cut.size() > before + 100);
        double worst = 1;
        for (; before < block.cut.size(); ++before) {
            worst = std::min(worst, double(std::abs(block.cut[before].normal[std::size_t(axis)])));
        }
        CAPTURE(axis);
        CHECK(worst > 1 - 1e-6);
    }
}
