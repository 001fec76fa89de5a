// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "machines/machine.h"
#include "tests/catch.h"
#include "tests/machines/bodies.h"
#include "tests/shared/block.h"

using namespace swage;

TEST_CASE("the work frame lies along the longest side, at the middle of the body") {
    const Vec3 centre(3, -2, 7);
    for (int axis = 0; axis < 3; ++axis) {
        const WorkFrame frame = place_work_frame(bar(axis, centre));
        CHECK((frame.size - Vec3(1, 0.1, 0.1)).norm() < 1e-12);
        CHECK((frame.world_from_work.translation - centre).norm() < 1e-12);
        CHECK((frame.world_from_work.turn(Vec3::UnitX()) - Vec3::Unit(axis)).norm() < 1e-12);
        const Vec3 up = axis == 1 ? Vec3::UnitZ() : Vec3::UnitY();
        CHECK((frame.world_from_work.turn(Vec3::UnitY()) - up).norm() < 1e-12);
    }
}

TEST_CASE("an upright machine lies along the longest side across up, however tall the body") {
    const Aggregate body = body_of(box_points({0, 0, 0}, {2, 3, 1}, {4, 6, 2}), 0.5);
    const auto axes = [&](WorldAxis up) {
        const Pose pose = place_work_frame(body, WorldAxis::automatic, up, true).world_from_work;
        return std::pair<Vec3, Vec3>(pose.turn(Vec3::UnitX()), pose.turn(Vec3::UnitY()));
    };
    for (const WorldAxis up : {WorldAxis::automatic, WorldAxis::y}) {
        CHECK((axes(up).first - Vec3::UnitX()).norm() < 1e-12);
        CHECK((axes(up).second - Vec3::UnitY()).norm() < 1e-12);
    }
    CHECK((axes(WorldAxis::minus_x).first - Vec3::UnitY()).norm() < 1e-12);
    CHECK((axes(WorldAxis::minus_x).second + Vec3::UnitX()).norm() < 1e-12);
    CHECK_THROWS_AS(place_work_frame(body, WorldAxis::automatic, WorldAxis::y), Error);
    CHECK_THROWS_AS(place_work_frame(body, WorldAxis::y, WorldAxis::automatic, true), Error);
}

TEST_CASE("the work frame follows the words of the scene, signs too, and stays right-handed") {
    const Aggregate body = body_of(box_points({0, 0, 0}, {3, 2, 1}, {6, 4, 2}), 0.5);
    const std::vector<std::pair<WorldAxis, Vec3>> ways = {
        {WorldAxis::x, {1, 0, 0}}, {WorldAxis::minus_x, {-1, 0, 0}},
        {WorldAxis::y, {0, 1, 0}}, {WorldAxis::minus_y, {0, -1, 0}},
        {WorldAxis::z, {0, 0, 1}}, {WorldAxis::minus_z, {0, 0, -1}}};
    for (const auto& [axis, x] : ways) {
        for (const auto& [up, y] : ways) {
            CHECK(lie_along(axis, up) == (x.cross(y).norm() == 0));
            if (lie_along(axis, up)) {
                CHECK_THROWS_AS(place_work_frame(body, axis, up), Error);
                continue;
            }
            const WorkFrame frame = place_work_frame(body, axis, up);
            const Pose& pose = frame.world_from_work;
            CHECK(world_axes(frame)[0] == axis);
            CHECK(world_axes(frame)[1] == up);
            CHECK(direction_of(world_axes(frame)[2]) == x.cross(y));
            CHECK((pose.turn(Vec3::UnitX()) - x).norm() < 1e-12);
            CHECK((pose.turn(Vec3::UnitY()) - y).norm() < 1e-12);
            CHECK((pose.turn(Vec3::UnitZ()) - x.cross(y)).norm() < 1e-12);
            // The sizes are those of the sides the axes lie along.
            CHECK((pose.turn(frame.size).cwiseAbs() - Vec3(3, 2, 1)).norm() < 1e-12);
        }
    }
}

TEST_CASE("the work frame is placed by the surface as it is now, not as it was molded") {
    Aggregate body = bar();
    for (double& x : body.particle_position.x) x = 4 + 2 * x;
    const WorkFrame frame = place_work_frame(body);
    CHECK(frame.size.x() == Approx(2));
    CHECK(frame.world_from_work.translation.x() == Approx(4));
}

TEST_CASE("how far the lattice reaches beyond the surface is told up to ten cells") {
    Aggregate matter = test::make_block(3, 8, 4, 0.1, Material{});
    const WorkFrame frame = place_work_frame(matter);
    const auto reach = [&] { return work_piece_variables(matter, frame).at("lattice_reach"); };
    CHECK(reach() == Approx(0).margin(1e-9));
    matter.particle_position.add(0, Vec3(0, -0.5, 0));
    CHECK(reach() == Approx(0.5));
    matter.particle_position.add(0, Vec3(0, -50, 0));  // driven far off
    CHECK(reach() == Approx(1));
}

TEST_CASE("the longest side is that of the skin, whatever samples of the surface miss of it") {
    const Aggregate body = body_of(box_points({0, 0, 0}, {1, 2, 1.9}, {4, 8, 8}), 0.25);
    const auto along = [&](const Box& skin) {
        return place_work_frame(body, WorldAxis::automatic, WorldAxis::automatic, false, skin)
            .world_from_work.turn(Vec3::UnitX());
    };
    CHECK(along({}).y() == 1);
    CHECK(along({{0, 0, 0}, {1, 2, 2.1}}).z() == 1);
    CHECK(along({{0, 0, 0}, {1, 2.1, 2}}).y() == 1);
    CHECK(along({{0, 0, 0}, {1, 2, 2.01}}).y() == 1);  // as long, and first
    CHECK(along({{0, 0, 0}, {1.995, 2, 2.01}}).x() == 1);
}

TEST_CASE("a body without a surface has no place for a machine") {
    CHECK_THROWS_AS(place_work_frame(Aggregate{}), Error);
}

TEST_CASE("where up lies along the longest side it is told which axes to set") {
    const auto refusal = [](WorldAxis axis) {
        try {
            place_work_frame(bar(0, Vec3::Zero()), axis, WorldAxis::minus_x);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(
        refusal(WorldAxis::automatic) ==
        "up = \"-x\" lies along the longest side of the work-piece as it is now, which is its axis "
        "where none is given; set axis = \"y\" or \"z\", or another up");
    CHECK(refusal(WorldAxis::x).ends_with("axis (x); choose another up, or an axis across it"));
}
