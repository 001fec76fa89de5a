// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on the surface beside a cut.
#include "matter/connections.h"
#include "sim/load_set.h"
#include "sim/sever.h"
#include "tests/sim/loads_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

const Vec3 kPush(2, -3, 1);

// Of each side of the cut by x, from the left [N].
std::array<Vec3, 2> borne(const Aggregate& matter, const LoadSet& loads, const Drive& now) {
    Vec3Array force;
    force.resize(matter.particle_count());
    loads.add_forces(matter, now, force);
    const Pieces pieces = find_pieces(matter);
    REQUIRE(pieces.count == 2);
    std::array<Vec3, 2> sum{Vec3(Vec3::Zero()), Vec3(Vec3::Zero())};
    for (std::size_t p = 0; p < force.size(); ++p) {
        sum[pieces.particle_piece[p] != pieces.particle_piece[0]] += force.at(p);
    }
    return sum;
}

Apparatus pushed_above(const Aggregate& matter, double from, double to) {
    Apparatus apparatus;
    apparatus.load.push_back(force_on(
        matter,
        points_where(matter,
                     [&](const Vec3& x) { return x.y() > 0.1499 && x.x() > from && x.x() < to; }),
        kPush));
    return apparatus;
}

}  // namespace

TEST_CASE("a force on one side of a cut pulls at that side alone, and acts where it is told to") {
    Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
    const Apparatus apparatus = pushed_above(matter, 0.013, 0.3);
    LoadSet loads(apparatus, {});
    const Drive now = drive_of(apparatus, 1, 1);
    sever_plane(matter, Vec3(0.013, 0, 0), Vec3::UnitX());
    loads.connections_changed(matter);
    const std::array<Vec3, 2> side = borne(matter, loads, now);
    CHECK(side[0].norm() < 1e-12);
    CHECK((side[1] - kPush).norm() < 1e-12);
    const LoadSum sum = loads.sums(matter, now).at(0);
    CHECK(sum.torque.norm() < 1e-12);
    // The torn cell's force has gone to its neighbour.
    CHECK(sum.centre.x() == Approx(0.15).margin(0.1));
}

TEST_CASE("of a force across a cut each side bears what lies on it, all of it where all is torn") {
    for (const double reach : {0.3, 0.1}) {
        Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
        const Apparatus apparatus = pushed_above(matter, reach > 0.2 ? -reach : 0, reach);
        LoadSet loads(apparatus, {});
        sever_plane(matter, Vec3(0.05, 0, 0), Vec3::UnitX());
        loads.connections_changed(matter);
        const std::array<Vec3, 2> side = borne(matter, loads, drive_of(apparatus, 1, 1));
        CHECK((side[0] + side[1] - kPush).norm() < 1e-12);
        const double left = reach > 0.2 ? 0.35 / 0.6 : 0.5;
        CHECK((side[0] - left * kPush).norm() < 1e-6);
    }
}

TEST_CASE("a force does no work where a cut alone makes it act elsewhere, and all where it goes") {
    Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
    const Apparatus apparatus = pushed_above(matter, -0.09, 0.3);
    LoadSet loads(apparatus, {});
    const Drive now = drive_of(apparatus, 1, 1);
    loads.start(matter, now);
    const Vec3 first(0.02, 0.01, 0), then(0, -0.2, 0.3);
    std::vector<double> work(1, 0.0);
    deform(matter, [&](const Vec3& x) { return Vec3(x + first); });
    sever_plane(matter, Vec3(0.013, 0, 0), Vec3::UnitX());
    loads.connections_changed(matter);
    loads.commit(matter, now, work);
    CHECK(work[0] == Approx(kPush.dot(first)).epsilon(1e-9));
    deform(matter, [&](const Vec3& x) { return Vec3(x + first + then); });
    loads.commit(matter, now, work);
    CHECK(work[0] == Approx(kPush.dot(first + then)).epsilon(1e-9));
}

TEST_CASE("a force is told to act where it does, wherever it has been spread unevenly") {
    const Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
    Apparatus apparatus = pushed_above(matter, -0.3, 0.3);
    Load& load = apparatus.load[0];
    Vec3 moment = Vec3::Zero();
    double all = 0;
    for (std::size_t n = 0; n < load.point.size(); ++n) {
        const Vec3 x = matter.surface_reference(std::size_t(load.point[n]));
        if (x.x() > 0) load.force[n] *= 3;
        moment += load.force[n].norm() * x;
        all += load.force[n].norm();
    }
    const LoadSum sum = LoadSet(apparatus, {}).sums(matter, drive_of(apparatus, 1, 1)).at(0);
    CHECK((sum.centre - moment / all).norm() < 1e-12);
    CHECK(sum.torque.norm() < 1e-12);
}
