// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/touch.h"

#include "tests/catch.h"
#include "tests/machines/bodies.h"

using namespace swage;

namespace {

std::vector<Vec3> ball_points(double radius, int count) {
    std::vector<Vec3> points;
    for (int n = 0; n < count; ++n) {  // a spiral from pole to pole
        const double height = 1 - 2 * (n + 0.5) / count;
        const double turn = n * kPi * (3 - std::sqrt(5.0));
        const double across = std::sqrt(1 - height * height);
        points.push_back(radius * Vec3(across * std::cos(turn), height, across * std::sin(turn)));
    }
    return points;
}

}  // namespace

TEST_CASE("a tool that slides towards a face stops at the face, less the gap") {
    const std::vector<Vec3> points = box_points({-1, -0.2, -0.3}, {1, 0.2, 0.3}, {40, 8, 12});
    const double gap = GENERATE(0.0, 0.03, -0.01);
    for (const Shape& shape : {Shape(CylinderShape{0.15, 2.0}), Shape(SphereShape{0.15}),
                               Shape(BoxShape{{0.3, 0.3, 0.3}, 0.05})}) {
        const auto shift =
            slide_to_touch(shape, {Quat::Identity(), {0, 5, 0}}, -Vec3::UnitY(), points, gap);
        REQUIRE(shift);
        // The points are 0.05 apart, so a ball between four of them would sink in a little; it
        // stands over one of them.
        CHECK(5 - *shift == Approx(0.2 + 0.15 + gap).margin(1e-8));
    }
}

TEST_CASE("the way a tool has to go does not depend on where it starts") {
    const std::vector<Vec3> points = box_points({-1, -0.2, -0.3}, {1, 0.2, 0.3}, {40, 8, 12});
    const Shape shape = SphereShape{0.1};
    for (const double start : {-3.0, 0.0, 0.1, 0.31, 40.0}) {
        const auto shift =
            slide_to_touch(shape, {Quat::Identity(), {0.1, start, 0}}, -Vec3::UnitY(), points, 0);
        REQUIRE(shift);
        CHECK(start - *shift == Approx(0.3).margin(1e-8));
    }
}

TEST_CASE("a tool touches a ball where two round things touch") {
    const std::vector<Vec3> points = ball_points(1, 40000);
    const Shape shape = SphereShape{0.5};
    const double aside = 0.9;
    const auto shift =
        slide_to_touch(shape, {Quat::Identity(), {aside, 0, 0}}, -Vec3::UnitY(), points, 0);
    REQUIRE(shift);
    CHECK(-*shift == Approx(std::sqrt(1.5 * 1.5 - aside * aside)).margin(2e-4));
    const Pose touching{Quat::Identity(), Vec3(aside, -*shift, 0)};
    CHECK(nearest_distance(shape, touching, points) == Approx(0).margin(1e-8));
}

TEST_CASE("the first contact stops a tool, though there is room farther in") {
    // A table: a top and two legs, too near for the tool to go between.
    std::vector<Vec3> points = box_points({-1, 0, -0.3}, {1, 0.1, 0.3}, {80, 4, 24});
    for (const double leg : {-0.3, 0.3}) {
        const auto more = box_points({leg - 0.05, -1, -0.3}, {leg + 0.05, 0, 0.3}, {4, 40, 24});
        points.insert(points.end(), more.begin(), more.end());
    }
    const auto lift = [&](double radius) {
        const auto shift =
            slide_to_touch(CylinderShape{radius, 1}, Pose{}, Vec3::UnitY(), points, 0);
        REQUIRE(shift);
        return *shift;
    };
    CHECK(lift(0.2) == Approx(-0.2).margin(1e-8));  // between the legs, up to the top
    CHECK(lift(0.249) == Approx(-0.249).margin(1e-8));
    // On the legs' inner edges, 0.25 to the side.
    CHECK(lift(0.4) == Approx(-1 - std::sqrt(0.16 - 0.0625)).margin(1e-8));
}

TEST_CASE("a tool that passes by touches nothing") {
    const std::vector<Vec3> points = box_points({-1, -0.2, -0.3}, {1, 0.2, 0.3}, {40, 8, 12});
    CHECK_FALSE(slide_to_touch(SphereShape{0.1}, {Quat::Identity(), {1.2, 0, 0}}, Vec3::UnitY(),
                               points, 0));
    CHECK_FALSE(slide_to_touch(SphereShape{0.1}, {Quat::Identity(), {1.0999, 0, 0.3999}},
                               Vec3::UnitY(), points, 0));
    CHECK(slide_to_touch(SphereShape{0.1}, {Quat::Identity(), {1.05, 0, 0}}, Vec3::UnitY(), points,
                         0));
}

TEST_CASE("a ring comes to rest on what is wider than its hole, and passes what is not") {
    const std::vector<Vec3> points = box_points({-1, -0.2, -0.3}, {1, 0.2, 0.3}, {40, 8, 12});
    const Pose above{turn_about(Vec3::UnitX(), 0.5 * kPi), {0, 3, 0}};
    const auto drop = [&](double hole, double rounding) {
        return slide_to_touch(CylinderShape{hole + 0.5, 0.2, hole, rounding}, above, -Vec3::UnitY(),
                              points, 0);
    };
    for (const double rounding : {0.0, 0.1}) {
        const auto on_top = drop(0.6, rounding);
        REQUIRE(on_top);
        CHECK(*on_top == Approx(3 - 0.2 - 0.1).margin(1e-8));
        CHECK_FALSE(drop(1.05, rounding));  // the block's corners are 1.044 from its middle
    }
    // On its rounded edge, whose lowest points are 1.1 from the axis.
    const auto by_edge = drop(1.0, 0.1);
    REQUIRE(by_edge);
    const double beside = 1.1 - std::hypot(1.0, 0.3);
    CHECK(*by_edge == Approx(3 - 0.2 - std::sqrt(0.01 - beside * beside)).margin(1e-8));
}

TEST_CASE("however thin a tool is, it stops where a thick one does, or passes by") {
    const std::vector<Vec3> points = box_points({-1, -0.2, -0.3}, {1, 0.2, 0.3}, {40, 8, 12});
    const Quat aslant = turn_about(Vec3::UnitX(), 0.3);
    for (const double thin : {1e-2, 1e-4, 1e-5, 1e-6, 1e-9}) {
        CAPTURE(thin);
        for (const double start : {-3.0, 0.2, 5.0}) {
            const auto shift =
                slide_to_touch(BoxShape{{3, thin, 3}, 0}, {Quat::Identity(), {0.1, start, 0}},
                               -Vec3::UnitY(), points, 0);
            REQUIRE(shift);
            CHECK(start - *shift == Approx(0.2 + 0.5 * thin).margin(1e-8));
        }
        const auto by_edge = slide_to_touch(BoxShape{{3, thin, 3}, 0}, {aslant, {0.1, 5, 0}},
                                            -Vec3::UnitY(), points, 0);
        REQUIRE(by_edge);  // on an edge of the block
        CHECK(5 - *by_edge ==
              Approx(0.2 + 0.3 * std::tan(0.3) + 0.5 * thin / std::cos(0.3)).margin(1e-8));
        // A wire over a row of points, and between two rows.
        const auto over =
            slide_to_touch(CylinderShape{0.5 * thin, 4}, {Quat::Identity(), {0.1, 5, 0}},
                           -Vec3::UnitY(), points, 0);
        REQUIRE(over);
        CHECK(5 - *over == Approx(0.2 + 0.5 * thin).margin(1e-8));
        CHECK_FALSE(slide_to_touch(CylinderShape{0.5 * thin, 4}, {Quat::Identity(), {0.125, 5, 0}},
                                   -Vec3::UnitY(), points, 0));
    }
}
