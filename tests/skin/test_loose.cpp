// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/loose_particles.h"

#include <cmath>
#include <random>

#include "geometry/mesh_check.h"
#include "skin/mount.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/boundary.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

using Map = std::function<Vec3(const Vec3&)>;

// Of radius 1/2.
Aggregate ball(int across) {
    const double a = 1.0 / across;
    return test::make_shape([](const Vec3& p) { return p.norm() - .5; },
                            Vec3::Constant(-.5 - .07 * a), Vec3i::Constant(across + 1), a);
}

// What pressing does to particles that hardly anything holds: up to this many spacings off.
void drive_about(Aggregate& matter, double spacings) {
    std::mt19937 random(3);
    for (ParticleId p : find_loose(matter).particle) {
        Vec3 way;
        for (double& x : way) x = 2.0 * random() / std::mt19937::max() - 1;
        matter.particle_position.add(p, spacings * matter.lattice.spacing * way.normalized());
    }
}

double largest_gap(const std::vector<Vec3>& is, const std::vector<Vec3>& rest, const Map& map) {
    double gap = 0;
    for (std::size_t n = 0; n < rest.size(); ++n) {
        gap = std::max(gap, (is[n] - map(rest[n])).norm());
    }
    return gap;
}

// To a quarter of its height, and sheared; keeps the volume.
Vec3 press(const Vec3& p) { return {2 * p.x() + .7 * p.y(), .25 * p.y(), 2 * p.z() + .3 * p.x()}; }

}  // namespace

TEST_CASE("the skin of a ball pressed flat keeps its volume, though slivers are driven about") {
    const int across = GENERATE(6, 12, 20);
    const double driven = GENERATE(0., .1, .5, 1.);
    Aggregate matter = ball(across);
    TriMesh skin = test::boundary_now(matter);
    const double volume = signed_volume(skin);
    const std::vector<Vec3> rest = skin.position;
    const Mount mount = mount_mesh(rest, matter, SkinKind::mount);
    REQUIRE_FALSE(find_loose(matter).particle.empty());
    test::deform(matter, press);
    drive_about(matter, driven);
    skin_positions(mount, matter, skin.position);
    const double most = std::min(driven, .15) / across;
    CHECK(largest_gap(skin.position, rest, press) < most + 1e-13);
    CHECK(signed_volume(skin) == Approx(volume).epsilon(driven == 0 ? 1e-12 : .003));
    skin = test::boundary_now(matter);
    CHECK(largest_gap(skin.position, rest, press) < most + 1e-13);
    CHECK(signed_volume(skin) == Approx(volume).epsilon(.003));  // its squares are split anew
}

TEST_CASE("a ball's skin follows what is quadratic exactly, what is not with the third order") {
    const auto quadratic = [](const Vec3& p) -> Vec3 {
        return p + Vec3(.3 * p.y() * p.y() - .2 * p.x() * p.z(), .2 * p.x() * p.x(), .1 * p.z());
    };
    const auto wave = [](const Vec3& p) -> Vec3 {
        return p + .06 * Vec3(std::sin(3 * p.y()), std::cos(2 * p.x() + p.z()), 0);
    };
    std::vector<double> error;
    for (int across : {8, 16}) {
        for (const Map& map : {Map(quadratic), Map(wave)}) {
            Aggregate matter = ball(across);
            const std::vector<Vec3> rest = test::boundary_now(matter).position;
            const Mount mount = mount_mesh(rest, matter, SkinKind::mount);
            test::deform(matter, map);
            std::vector<Vec3> now;
            skin_positions(mount, matter, now);
            error.push_back(largest_gap(now, rest, map));
        }
    }
    // Not quite: a particle at which only two stand in a row has a slope of the first order.
    CHECK(error[0] < 3e-3 / 8);
    CHECK(error[2] < 3e-3 / 16);
    CHECK(error[3] < error[1] / 3.5);
}

TEST_CASE("a loose particle that is cut off from firm matter goes its own way") {
    Aggregate matter = ball(9);
    const LooseParticles loose = find_loose(matter);
    const Vec3 away(0, .3, 0);
    test::sever_plane(matter, {0, .42, 0}, Vec3::UnitY());
    test::deform(matter, [&](const Vec3& p) { return p.y() > .42 ? Vec3(p + away) : p; });
    const auto moved = loose_displacements(loose, matter, matter.particle_reference.all());
    int above = 0;
    for (std::size_t n = 0; n < moved.size(); ++n) {
        const bool is_above = matter.particle_reference.at(loose.particle[n]).y() > .42;
        above += is_above;
        CHECK((moved[n] - (is_above ? away : Vec3(Vec3::Zero()))).norm() < 1e-15);
    }
    CHECK(above > 0);
}

TEST_CASE("beside a cut a loose particle is drawn back by what firm matter is left on its side") {
    Aggregate matter = ball(9);
    const Vec3 normal = Vec3(1, .2, .1).normalized(), away(.5, 0, 0);
    const auto side = [&](const Vec3& p) { return normal.dot(p) > .01; };
    const LooseParticles loose = find_loose(matter);
    test::sever_plane(matter, .01 * normal, normal);
    test::deform(matter, [&](const Vec3& p) { return side(p) ? Vec3(p + away) : p; });
    drive_about(matter, 9);
    const auto moved = loose_displacements(loose, matter, matter.particle_reference.all());
    const double spacing = matter.lattice.spacing;
    int beside = 0;
    for (std::size_t n = 0; n < moved.size(); ++n) {
        const Vec3 p = matter.particle_reference.at(loose.particle[n]);
        const Vec3 should = side(p) ? away : Vec3(Vec3::Zero());
        CHECK((moved[n] - should).norm() < .15001 * spacing);
        CHECK((moved[n] - should).norm() > .14999 * spacing);  // no farther than that
        beside += std::abs(normal.dot(p) - .01) < spacing;
    }
    CHECK(beside > 10);
}

TEST_CASE("beside a cut a loose particle that is near its place on its side stays as it is") {
    Aggregate matter = ball(9);
    const Vec3 normal = Vec3(1, .2, .1).normalized();
    const LooseParticles loose = find_loose(matter);
    test::sever_plane(matter, .01 * normal, normal);
    test::deform(matter,
                 [&](const Vec3& p) { return normal.dot(p) > .01 ? Vec3(p + Vec3(.5, 0, 0)) : p; });
    drive_about(matter, .1);
    const auto moved = loose_displacements(loose, matter, matter.particle_reference.all());
    REQUIRE(moved.size() > 10);
    for (std::size_t n = 0; n < moved.size(); ++n) {
        const ParticleId p = loose.particle[n];
        const Vec3 own = matter.particle_position.at(p) - matter.particle_reference.at(p);
        CHECK((moved[n] - own).norm() == 0);
    }
}

TEST_CASE("a fin thinner than a sliver is left to itself") {
    // A block with a fin a quarter of a cell thick, that stands four cells high on it.
    std::vector<Vec3i> cells;
    std::vector<float> fill;
    for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < 5; ++i) {
            if (j > 1 && i != 2) continue;
            cells.emplace_back(i, j, 0);
            fill.push_back(j > 1 ? .25f : 1.f);
        }
    }
    Aggregate matter = test::make_matter(Vec3::Zero(), 1, Vec3i(5, 6, 1), cells, fill);
    const LooseParticles loose = find_loose(matter);
    for (ParticleId p : loose.particle) CHECK(matter.particle_reference.at(p).y() < 2);
    const std::vector<Vec3> places = {{2.5, 2.7, .5}, {2.4, 5.9, .2}};
    const Mount mount = mount_mesh(places, matter, SkinKind::mount);
    const auto bent = [](const Vec3& p) -> Vec3 {
        const double up = std::max(0., p.y() - 2);
        return p + Vec3(.3 * up * up, 0, 0);
    };
    test::deform(matter, bent);
    std::vector<Vec3> now;
    skin_positions(mount, matter, now);
    CHECK(largest_gap(now, places, bent) < .1);
}
