// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/skin_volume.h"

#include <cmath>

#include "geometry/box_mesh.h"
#include "skin/divided_mesh.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

constexpr double kSpacing = 1.0 / 3;

// A cube, as pressed between plates that hold its ends: its sides swell, in a curve.
Vec3 swell(const Vec3& p) {
    const double out = 1 + (0.25 - p.y() * p.y());
    return {out * p.x(), 0.8 * p.y(), out * p.z()};
}

struct Cube {
    Aggregate matter = test::make_block(3, 3, 3, kSpacing, Material{});
    TriMesh skin = divide_edges(box_mesh(Vec3::Constant(-.5), Vec3::Constant(.5)), kSpacing / 4);
    Mount mount;
    std::vector<Vec3> position;

    explicit Cube(const std::function<Vec3(const Vec3&)>& map, SkinKind kind = SkinKind::mount)
        : mount(mount_mesh(skin.position, matter, kind)) {
        test::deform(matter, map);
        skin_positions(mount, matter, position);
    }
    double volume() const { return enclosed_volume(skin, position).value(); }
    // By how much a vertex moves at most, asked for that volume.
    double enclose(double asked) {
        const std::vector<Vec3> before = position;
        enclose_volume(skin, mount, matter, asked, position);
        double most = 0;
        for (std::size_t v = 0; v < before.size(); ++v) {
            most = std::max(most, (position[v] - before[v]).norm());
        }
        return most;
    }
};

}  // namespace

TEST_CASE("a skin that swells between its particles encloses what it is asked for") {
    Cube cube(swell);
    const double rounded = cube.volume();
    const double asked = rounded - GENERATE(.001, .005, .01, -.005);
    CHECK(cube.enclose(asked) < .1 * kSpacing);
    CHECK(cube.volume() == Approx(asked).epsilon(1e-6));
    double off = 0;  // its flat ends stay flat, out to their edges
    for (std::size_t v = 0; v < cube.position.size(); ++v) {
        const double y = cube.skin.position[v].y();
        if (std::abs(y) > .4999) off = std::max(off, std::abs(cube.position[v].y() - .8 * y));
    }
    CHECK(off < 1e-3 * kSpacing);
}

TEST_CASE("a skin goes no farther for its volume than it is rounded by") {
    Cube cube(swell);
    const double rounded = cube.volume();
    // A side swells by 0.125 in the middle; between two particles it is rounded by a ninth of that.
    CHECK(cube.enclose(.5 * rounded) < std::sqrt(2.) * .125 / 9);
    CHECK(cube.volume() < rounded);
    CHECK(cube.volume() > .9 * rounded);
}

TEST_CASE("a skin that is strained alike all over, or turned, stays whatever volume is asked") {
    const Quat turn(Eigen::AngleAxisd(1.1, Vec3(1, -2, .5).normalized()));
    Cube cube([&](const Vec3& p) -> Vec3 {
        return turn * Vec3(1.3 * p.x() + .4 * p.y(), .7 * p.y(), p.z()) + Vec3(5, -7, 3);
    });
    CHECK(cube.enclose(.8) < 1e-13);
}

TEST_CASE("a skin is brought to its volume however it is turned") {
    const Quat turn(Eigen::AngleAxisd(2.1, Vec3(1, -2, .5).normalized()));
    Cube cube(swell);
    Cube turned([&](const Vec3& p) -> Vec3 { return turn * swell(p); });
    const double asked = cube.volume() - .005;
    cube.enclose(asked);
    turned.enclose(asked);
    double gap = 0;
    for (std::size_t v = 0; v < cube.position.size(); ++v) {
        gap = std::max(gap, (turned.position[v] - turn * cube.position[v]).norm());
    }
    CHECK(gap < 1e-12);
}

TEST_CASE("a skin that is open, and one by frames of four particles, has no volume to keep") {
    Cube open(swell);
    open.skin.triangle.pop_back();
    CHECK_FALSE(enclosed_volume(open.skin, open.position));
    CHECK(open.enclose(.8) == 0);
    // A tube is open too, though its faces sum up to nothing.
    Cube tube(swell);
    std::erase_if(tube.skin.triangle, [&](const Corners& t) {
        const auto y = [&](int v) { return tube.skin.position[std::size_t(v)].y(); };
        return std::abs(y(t[0]) + y(t[1]) + y(t[2])) > 1.5 - 1e-9;
    });
    REQUIRE(tube.skin.triangle.size() < Cube(swell).skin.triangle.size());
    CHECK_FALSE(enclosed_volume(tube.skin, tube.position));
    Cube frame4(swell, SkinKind::frame4);
    CHECK(frame4.enclose(.8) == 0);
}
