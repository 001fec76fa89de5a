// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/shape.h"

#include <map>

#include "base/parallel.h"
#include "geometry/box_mesh.h"
#include "geometry/distance_field.h"
#include "geometry/triangle_tree.h"
#include "tests/catch.h"

using namespace swage;

namespace {

// Points spread evenly over a box, the same on every machine (additive recurrence).
std::vector<Vec3> spread_points(const Box& box, int count) {
    std::vector<Vec3> points;
    for (int n = 1; n <= count; ++n) {
        const Vec3 share(std::fmod(n * 0.8191725134, 1), std::fmod(n * 0.6710436067, 1),
                         std::fmod(n * 0.5497004779, 1));
        points.push_back(box.low + share.cwiseProduct(box.size()));
    }
    return points;
}

Box grown(const Box& box, double by) {
    return {box.low - Vec3::Constant(by), box.high + Vec3::Constant(by)};
}

Vec3 slope_of(const Shape& shape, const Vec3& p, double step) {
    Vec3 slope;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 d = step * Vec3::Unit(axis);
        slope[axis] =
            (distance_to(shape, p + d).value - distance_to(shape, p - d).value) / (2 * step);
    }
    return slope;
}

TriMesh ball(double radius, int rings) {
    TriMesh mesh;
    const int around = 2 * rings;
    mesh.position.push_back({0, 0, -radius});
    for (int r = 1; r < rings; ++r) {
        const double polar = kPi * r / rings;
        for (int n = 0; n < around; ++n) {
            const double turn = 2 * kPi * n / around;
            mesh.position.push_back(radius * Vec3(std::sin(polar) * std::cos(turn),
                                                  std::sin(polar) * std::sin(turn),
                                                  -std::cos(polar)));
        }
    }
    mesh.position.push_back({0, 0, radius});
    const auto id = [&](int r, int n) {
        if (r == 0) return 0;
        if (r == rings) return static_cast<int>(mesh.position.size()) - 1;
        return 1 + (r - 1) * around + n % around;
    };
    for (int r = 0; r < rings; ++r) {
        for (int n = 0; n < around; ++n) {
            if (r > 0) mesh.triangle.push_back({id(r, n), id(r, n + 1), id(r + 1, n)});
            if (r + 1 < rings) {
                mesh.triangle.push_back({id(r, n + 1), id(r + 1, n + 1), id(r + 1, n)});
            }
        }
    }
    return mesh;
}

double volume_of(const TriMesh& mesh) {
    double six = 0;
    for (const Corners& t : mesh.triangle) {
        six += mesh.position[t[0]].dot(mesh.position[t[1]].cross(mesh.position[t[2]]));
    }
    return six / 6;
}

MeshShape mesh_shape(TriMesh mesh, double spacing = 0) {
    auto shared = std::make_shared<const TriMesh>(std::move(mesh));
    return {shared, std::make_shared<const DistanceField>(*shared, spacing)};
}

}  // namespace

TEST_CASE("the gradient of an exact shape is its unit normal") {
    const std::vector<Shape> shapes = {CylinderShape{0.3, 1.1},
                                       CylinderShape{0.3, 1.1, 0, 0.2},
                                       CylinderShape{0.5, 0.4, 0.2},
                                       CylinderShape{0.5, 0.4, 0.2, 0.1},
                                       BoxShape{{0.5, 0.9, 0.7}, 0.1},
                                       BoxShape{{0.5, 0.9, 0.7}, 0.0},
                                       SphereShape{0.4}};
    for (const Shape& shape : shapes) {
        int checked = 0;
        for (const Vec3& p : spread_points(grown(bounds_of(shape), 0.3), 3000)) {
            const Distance d = distance_to(shape, p);
            REQUIRE(d.normal.norm() == Approx(1));
            const Vec3 slope = slope_of(shape, p, 1e-6);
            if (std::abs(slope.norm() - 1) > 1e-3) continue;  // on a crease of the inside
            CHECK((slope - d.normal).norm() < 1e-3);
            ++checked;
        }
        CHECK(checked > 2980);
    }
}

TEST_CASE("the distance of an exact shape leads to its surface") {
    const std::vector<Shape> shapes = {CylinderShape{0.3, 1.1}, CylinderShape{0.3, 1.1, 0.1, 0.1},
                                       CylinderShape{0.3, 1.1, 0, 0.2},
                                       BoxShape{{0.5, 0.9, 0.7}, 0.1}, SphereShape{0.4}};
    for (const Shape& shape : shapes) {
        for (const Vec3& p : spread_points(grown(bounds_of(shape), 0.5), 1000)) {
            const Distance d = distance_to(shape, p);
            CHECK(distance_to(shape, p - d.value * d.normal).value == Approx(0).margin(1e-12));
        }
    }
}

TEST_CASE("closed forms of a distance hold on faces, edges and corners") {
    const Shape cylinder = CylinderShape{1, 2};
    CHECK(distance_to(cylinder, {0, 0, 0}).value == Approx(-1));
    CHECK(distance_to(cylinder, {3, 0, 0}).value == Approx(2));
    CHECK(distance_to(cylinder, {0, 0, -1.5}).value == Approx(0.5));
    CHECK(distance_to(cylinder, {4, 0, 5}).value == Approx(5));
    CHECK((distance_to(cylinder, {4, 0, 5}).normal - Vec3(0.6, 0, 0.8)).norm() < 1e-12);
    const Shape ring = CylinderShape{3, 2, 1, 0.5};
    CHECK(distance_to(ring, {0, 0, 0}).value == Approx(1));
    CHECK(distance_to(ring, {0.5, 0, 0}).value == Approx(0.5));
    CHECK((distance_to(ring, {0, 0.5, 0}).normal - Vec3(0, -1, 0)).norm() < 1e-12);
    CHECK(distance_to(ring, {0, 2, 0}).value == Approx(-1));
    CHECK(distance_to(ring, {0, 0, 9}).value == Approx(std::hypot(1.5, 8.5) - 0.5));
    CHECK(distance_to(ring, {1, 0, 1}).value == Approx(0.5 * (std::sqrt(2.0) - 1)));
    CHECK(distance_to(ring, {0, -3, -1}).value == Approx(0.5 * (std::sqrt(2.0) - 1)));
    CHECK_FALSE(is_convex(ring));
    CHECK(is_convex(cylinder));
    CHECK(thinness_of(ring) == 2);
    CHECK(thinness_of(CylinderShape{3, 9, 1}) == 2);
    const Shape box = BoxShape{{2, 4, 6}, 0.5};
    CHECK(distance_to(box, {0, 0, 0}).value == Approx(-1));
    CHECK(distance_to(box, {0, 3, 0}).value == Approx(1));
    CHECK(distance_to(box, {1, 2, 3}).value == Approx(0.5 * (std::sqrt(3.0) - 1)));
    // A rounding that is too big for the box makes it as round as it can be.
    CHECK(distance_to(BoxShape{{2, 2, 2}, 9}, {0, 0, 1}).value == Approx(0).margin(1e-12));
}

TEST_CASE("every point of a shape has a normal, its axis and centre too") {
    const std::vector<Shape> shapes = {CylinderShape{1, 9}, CylinderShape{1, 9, 0.5, 0.25},
                                       BoxShape{{1, 1, 1}, 0}, BoxShape{{1, 1, 1}, 0.5},
                                       SphereShape{1}};
    for (const Shape& shape : shapes) {
        for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0, 0, 0.5), Vec3(0.5, 0.5, 0.5)}) {
            CHECK(distance_to(shape, p).normal.norm() == Approx(1));
        }
    }
}

TEST_CASE("a shape's drawn surface is closed, lies on it and winds outward") {
    struct Case {
        Shape shape;
        double volume, tolerance;
    };
    const double r = 0.1;
    const Vec3 core(0.3, 0.7, 0.5);
    const double rounded =
        core.prod() + 2 * r * (core.x() * core.y() + core.y() * core.z() + core.z() * core.x()) +
        kPi * r * r * core.sum() + 4.0 / 3 * kPi * r * r * r;
    // By Pappus: parts of the outline, times the ways of their middles.
    const double inner = 0.2, quarter = 0.25 * kPi * r * r;
    const double knob = kPi * inner * inner * 1.1 +
                        2 * kPi * (inner + 0.5 * r) * r * (1.1 - 2 * r) +
                        4 * kPi * (inner + 4 * r / (3 * kPi)) * quarter;
    const double ring = 2 * kPi * 0.35 * (0.3 * 0.4 - 4 * (r * r - quarter));
    const std::vector<Case> cases = {
        {CylinderShape{0.3, 1.1}, kPi * 0.09 * 1.1, 0.003},
        {CylinderShape{0.3, 1.1, 0, r}, knob, 0.003},
        {CylinderShape{0.5, 0.4, 0.2, r}, ring, 0.003},
        {CylinderShape{0.5, 0.4, 0.2}, kPi * (0.25 - 0.04) * 0.4, 0.003},
        {CylinderShape{0.5, 0.4, 0.2, 0.15}, -1, 0},
        {CylinderShape{0.3, 1.1, 0, 0.3}, -1, 0},
        {CylinderShape{0.3, 0.2, 0, 0.1}, -1, 0},
        {BoxShape{{0.5, 0.9, 0.7}, r}, rounded, 0.002},
        {BoxShape{{0.5, 0.9, 0.7}, 0}, 0.5 * 0.9 * 0.7, 1e-12},
        {BoxShape{{0.5, 0.9, 0.7}, 0.25}, -1, 0},
        {SphereShape{0.4}, 4.0 / 3 * kPi * 0.064, 0.002},
    };
    for (const Case& one : cases) {
        const TriMesh mesh = surface_of(one.shape);
        std::map<std::pair<int, int>, int> edges;
        for (const Corners& t : mesh.triangle) {
            for (int c = 0; c < 3; ++c) ++edges[{t[c], t[(c + 1) % 3]}];
        }
        for (const auto& [edge, count] : edges) {
            REQUIRE(count == 1);
            REQUIRE(edges.count({edge.second, edge.first}) == 1);
        }
        const double size = bounds_of(one.shape).size().minCoeff();
        for (const Vec3& p : mesh.position) {
            CHECK(std::abs(distance_to(one.shape, p).value) < 0.01 * size);
        }
        if (one.volume > 0) CHECK(volume_of(mesh) == Approx(one.volume).epsilon(one.tolerance));
        REQUIRE(mesh.triangle_smooth.size() == mesh.triangle.size());
        const Box drawn = box_of(mesh.position), said = bounds_of(one.shape);
        CHECK((drawn.low - said.low).norm() < 1e-3 * size);
        CHECK((drawn.high - said.high).norm() < 1e-3 * size);
    }
}

TEST_CASE("a mesh's distance field converges to the distance with the third order") {
    const TriMesh mesh = ball(1, 200);
    std::vector<double> error;
    for (const double spacing : {0.4, 0.2, 0.1}) {
        const DistanceField field(mesh, spacing);
        double worst = 0;
        for (const Vec3& direction : spread_points({Vec3::Constant(-1), Vec3::Constant(1)}, 400)) {
            for (const double radius : {0.9, 1.0, 1.1}) {
                const Vec3 p = radius * direction.normalized();
                worst = std::max(worst, std::abs(field.at(p).value - (radius - 1)));
            }
        }
        error.push_back(worst);
    }
    CHECK(std::log2(error[0] / error[1]) > 2.5);
    CHECK(std::log2(error[1] / error[2]) > 2.3);  // the flat triangles begin to show
    CHECK(error[2] < 2e-4);
}

TEST_CASE("a thin mesh has an inside, and its surfaces are where they are") {
    for (const double thickness : {4e-4, 2e-4}) {
        INFO(thickness);
        const Vec3 half = 0.5 * Vec3(0.06, thickness, 0.04);
        const DistanceField field(box_mesh(-half, half));
        for (const double x : {-0.0213, -0.0071, 0.0, 0.0004, 0.0117, 0.0199}) {
            CHECK(field.at({x, 0, 0.3 * x}).value < -0.25 * thickness);
            for (const double side : {-1, 1}) {
                const Distance d = field.at({x, side * half.y(), 0.3 * x});
                CHECK(std::abs(d.value) < 0.02 * thickness);
                CHECK((d.normal - side * Vec3::UnitY()).norm() < 0.02);
            }
        }
    }
}

TEST_CASE("a mesh that is not thin is sampled at an 80th of its longest side") {
    const Vec3 size(0.08, 0.02, 0.01);
    CHECK(DistanceField(box_mesh(-size / 2, size / 2)).spacing() == size.x() / 80);
    CHECK(DistanceField(ball(1, 40)).spacing() == 2.0 / 80);
}

TEST_CASE("a mesh's normal is the gradient of its distance, of length one near the surface") {
    const Shape shape = mesh_shape(ball(1, 100), 0.05);
    for (const Vec3& direction : spread_points({Vec3::Constant(-1), Vec3::Constant(1)}, 500)) {
        const Vec3 outward = direction.normalized();
        for (const double radius : {0.9, 0.99, 1.04, 1.1}) {
            const Vec3 p = radius * outward;
            const Vec3 slope = slope_of(shape, p, 1e-4);
            CHECK(slope.norm() == Approx(1).margin(5e-3));
            CHECK((slope.normalized() - distance_to(shape, p).normal).norm() < 1e-4);
            CHECK((distance_to(shape, p).normal - outward).norm() < 5e-3);
        }
    }
}

TEST_CASE("a mesh's distance and normal do not jump from sample to sample") {
    const DistanceField field(ball(1, 40), 0.1);
    const Vec3 along = Vec3(0.4, 0.5, 0.77).normalized(), start(-0.7, -0.6, 0.4);
    const double step = 1e-5;
    for (double s = 0; s < 1.5; s += step) {
        const Distance here = field.at(start + s * along),
                       next = field.at(start + (s + step) * along);
        if (std::abs(here.value) > 0.5) continue;  // the middle has a crease
        REQUIRE(std::abs(next.value - here.value) < 1.2 * step);
        REQUIRE((next.normal - here.normal).norm() < 10 * step);
    }
}

TEST_CASE("beyond its samples a mesh's distance goes on, positive and without a jump") {
    const DistanceField field(ball(1, 60), 0.05);
    for (const Vec3& direction : spread_points({Vec3::Constant(-1), Vec3::Constant(1)}, 200)) {
        const Vec3 outward = direction.normalized();
        for (const double radius : {1.3, 2.0, 10.0, 1000.0}) {
            const Distance d = field.at(radius * outward);
            CHECK(d.value == Approx(radius - 1).epsilon(5e-3));
            CHECK((d.normal - outward).norm() < 0.05);
        }
    }
    const double border = field.sampled().high.x();
    CHECK(field.at({border + 1e-9, 0.3, 0.2}).value ==
          Approx(field.at({border - 1e-9, 0.3, 0.2}).value).margin(1e-7));
}

TEST_CASE("inside and outside are told apart on a mesh with a hole, and on one turned inside out") {
    TriMesh open = ball(1, 40);
    open.triangle.resize(open.triangle.size() * 29 / 30);  // some of the top is missing
    TriMesh turned = ball(1, 40);
    for (Corners& t : turned.triangle) std::swap(t[1], t[2]);
    for (const TriMesh& mesh : {open, turned}) {
        const DistanceField field(mesh, 0.1);
        CHECK(field.at({0, 0, 0}).value < -0.8);
        CHECK(field.at({0.85, 0, 0}).value < 0);
        CHECK(field.at({1.15, 0, 0}).value > 0);
    }
}

TEST_CASE("the winding number of a closed surface is one inside and nought outside") {
    const TriangleTree tree(ball(1, 40));
    for (const Vec3& p : spread_points({Vec3::Constant(-1.5), Vec3::Constant(1.5)}, 2000)) {
        if (std::abs(p.norm() - 1) < 0.01) continue;
        CHECK(tree.winding_number(p) == Approx(p.norm() < 1 ? 1 : 0).margin(0.02));
        CHECK(tree.distance(p) == Approx(std::abs(p.norm() - 1)).margin(2e-3));
    }
}

TEST_CASE("the nearest place of a surface is as far as its distance, and no corner is nearer") {
    const TriMesh mesh = ball(1, 12);
    const TriangleTree tree(mesh);
    for (const Vec3& p : spread_points({Vec3::Constant(-1.5), Vec3::Constant(1.5)}, 500)) {
        const auto [triangle, weight] = tree.nearest(p);
        CHECK(weight.sum() == Approx(1).margin(1e-12));
        CHECK(weight.minCoeff() >= -1e-12);
        Vec3 place = Vec3::Zero();
        for (int c = 0; c < 3; ++c) {
            const Vec3& corner = mesh.position[mesh.triangle[triangle][c]];
            place += weight[c] * corner;
            CHECK(tree.distance(p) <= (p - corner).norm() + 1e-12);
        }
        CHECK((p - place).norm() == Approx(tree.distance(p)).margin(1e-12));
    }
}

TEST_CASE("a distance field is the same to the bit at any number of threads") {
    const TriMesh mesh = ball(1, 30);
    set_thread_count(1);
    const DistanceField one(mesh, 0.1);
    set_thread_count(3);
    const DistanceField three(mesh, 0.1);
    set_thread_count(0);
    for (const Vec3& p : spread_points({Vec3::Constant(-1.5), Vec3::Constant(1.5)}, 500)) {
        CHECK(one.at(p).value == three.at(p).value);
        CHECK(one.at(p).normal == three.at(p).normal);
    }
}

TEST_CASE("a surface without triangles or extent has no distance field") {
    CHECK_THROWS(DistanceField(TriMesh{}));
    TriMesh point;
    point.position = {Vec3::Zero()};
    point.triangle = {{0, 0, 0}};
    CHECK_THROWS(DistanceField(point));
}
