// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/touch_points.h"

#include "tests/catch.h"
#include "tests/shared/cells.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kA = 0.1;

Vec3 place_of(const TouchPoints& touch, std::size_t p, const Aggregate& m) {
    return touch.points().reference(p, m.particle_reference);
}

}  // namespace

TEST_CASE("seen from each side of a block its points have that side's area, and its middle") {
    const Vec3i count(4, 3, 2);
    const Aggregate m = make_block(4, 3, 2, kA, Material{});
    const Vec3 half = 0.5 * kA * count.cast<double>();
    const TouchPoints touch(m);
    const std::size_t edges = 4 * 2 * static_cast<std::size_t>(count.sum());
    CHECK(touch.size() == m.surface.size() + edges + 8);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double end : {-1.0, 1.0}) {
            double area = 0;
            Vec3 first = Vec3::Zero(), second = Vec3::Zero();
            for (std::size_t p = 0; p < touch.size(); ++p) {
                const Vec3 at = place_of(touch, p, m);
                if (std::abs(at[axis] - end * half[axis]) > 1e-6) continue;
                area += touch.points().area(p);
                first += touch.points().area(p) * at;
                second += touch.points().area(p) * at.cwiseAbs2();
            }
            const Vec3 size = 2 * half;
            const double whole = size.prod() / size[axis];
            CHECK(area == Approx(whole).epsilon(1e-6));
            CHECK((first / area - end * half[axis] * Vec3::Unit(axis)).norm() < 1e-6 * kA);
            for (int d = 0; d < 3; ++d) {  // that of a plate, to the points' own width
                if (d == axis) continue;
                CHECK(second[d] / area == Approx(size[d] * size[d] / 12).margin(0.03 * kA * kA));
            }
        }
    }
}

TEST_CASE("points at edges and corners have what the patches beside them give") {
    const Aggregate m = make_block(4, 4, 4, kA, Material{});
    const TouchPoints touch(m);
    const double patch = kA * kA / 4;
    std::array<int, 4> found{};
    for (std::size_t p = 0; p < touch.size(); ++p) {
        const Vec3 at = place_of(touch, p, m) / kA;
        const int sides = static_cast<int>((at.array().abs() > 2 - 1e-4).count());
        const int near = static_cast<int>((at.array().abs() > 1.55).count());
        ++found[sides];
        const double area = touch.points().area(p) / patch;
        CAPTURE(at.transpose(), area);
        if (sides == 3) CHECK(area == Approx(1.0 / 16));
        if (sides == 2) CHECK(area == Approx(near == 3 ? 3.0 / 16 : 1.0 / 4));
        if (sides == 1) CHECK(area == Approx(near == 3 ? 9.0 / 16 : near == 2 ? 3.0 / 4 : 1));
        // What a patch gave to an edge it lacks there, so its middle lies farther in.
        if (sides == 1 && near > 1) {
            const double in = near == 2 ? 1.0 / 3 : 13.0 / 36;
            CHECK((at.array().abs() - (2 - in)).abs().minCoeff() < 1e-5);
        }
        CHECK(touch.points().normal(p).norm() == Approx(1));
        CHECK(touch.points().normal(p).dot(at) > 0);
    }
    CHECK(found == std::array<int, 4>{0, 6 * 64, 12 * 8, 8});
}

TEST_CASE("a hollow edge has no points") {
    const auto is_there = [](const Vec3i& at) { return at.x() < 2 || at.y() < 2; };
    const Aggregate m = make_cells(Vec3::Zero(), Vec3i(4, 4, 2), kA, Material{}, is_there);
    const TouchPoints touch(m);
    std::size_t at_edges = 0;
    for (std::size_t p = m.surface.size(); p < touch.size(); ++p) {
        const Vec3 at = place_of(touch, p, m) / kA;
        const bool is_hollow = std::abs(at.x() - 2) < 0.1 && std::abs(at.y() - 2) < 0.1 &&
                               at.z() > 0.1 && at.z() < 1.9;
        CHECK_FALSE(is_hollow);
        ++at_edges;
    }
    CHECK(at_edges > 0);
}

TEST_CASE("where a cell is parted, whole ones look at it half a spacing before their faces") {
    Aggregate m = make_block(4, 1, 1, kA, Material{});
    TouchPoints touch(m);
    const std::size_t own = touch.own();
    CHECK(touch.size() == own);
    sever_plane(m, Vec3(0.05, 0, 0), Vec3::UnitX());  // through its third cell
    touch.connections_changed(m);
    REQUIRE(touch.size() == own + 2);
    for (std::size_t p = own; p < touch.size(); ++p) {
        CHECK(touch.meets(int(p)));
        CHECK_FALSE(touch.is_loose(int(p)));
        const Vec3 out = touch.points().normal(p);
        const double face = out.x() > 0 ? 0 : 0.1;
        CHECK((place_of(touch, p, m) - Vec3(face, 0, 0) - 0.5 * kA * out).norm() < 1e-6);
        CHECK(touch.points().area(p) == Approx(kA * kA));
        CHECK(touch.home()[p].x() == (out.x() > 0 ? 1 : 3));
    }
}

TEST_CASE("what a blade leaves of a cell meets tools where it lies, by its own side alone") {
    Aggregate m = make_block(6, 3, 3, kA, Material{});
    const Vec3 at(0.02, 0, 0), normal = Vec3(1, GENERATE(0.0, 0.3), 0).normalized();
    const TouchPoints molded(m);
    TouchPoints touch = molded, among_bodies(m, false);
    sever_plane(m, at, normal);
    const auto changed = touch.connections_changed(m);
    CHECK(among_bodies.connections_changed(m).empty());
    std::size_t carried = 0, parted = 0;
    for (std::size_t p = 0; p < touch.own(); ++p) {
        CHECK(touch.meets(int(p)));
        CHECK((place_of(touch, p, m) - place_of(molded, p, m)).norm() < 1e-6);
        CHECK(among_bodies.meets(int(p)) == cell_is_whole(m, molded.points().row(p)));
        carried += touch.points().row(p) != molded.points().row(p);
        parted += !cell_is_whole(m, molded.points().row(p));
        const double beyond = normal.dot(place_of(molded, p, m) - at);
        if (std::abs(beyond) < 0.3 * kA && p >= m.surface.size()) continue;  // as its patch
        const SurfacePoints::Carriers by = touch.points().carriers(p);
        for (int c = 0; c < 8; ++c) {
            if (by.weight[c] == 0) continue;
            CHECK((normal.dot(m.particle_reference.at(std::size_t(by.corner[c])) - at) > 0) ==
                  (beyond > 0));
        }
    }
    CHECK(carried == parted);
    CHECK(changed.size() == parted);
    // And a step back makes all of it whole again.
    for (ConnectionArrays& all : m.connection) {
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            if (all.weight[p] <= 0) all.weight.set(p, 1);
        }
    }
    CHECK(touch.connections_changed(m).size() == parted);
    for (std::size_t p = 0; p < touch.own(); ++p) {
        CHECK(touch.points().row(p) == molded.points().row(p));
        CHECK(touch.points().place(p) == molded.points().place(p));
    }
}

TEST_CASE("the outside of what only a crack has parted meets nothing") {
    Aggregate m = make_block(4, 1, 1, kA, Material{});
    TouchPoints touch(m);
    sever_plane(m, Vec3(0.05, 0, 0), Vec3::UnitX(), [](const Vec3&) { return true; });
    touch.connections_changed(m);
    for (std::size_t p = 0; p < m.surface.size(); ++p) {
        CHECK(touch.meets(int(p)) == cell_is_whole(m, m.surface.row(p)));
    }
}

TEST_CASE("particles that no whole cell has left meet by themselves, with a cell's face each") {
    Aggregate m = make_block(3, 1, 1, kA, Material{});
    TouchPoints touch(m);
    sever_plane(m, Vec3(0.1, 0, 0), Vec3::UnitX());  // through its last cell
    touch.connections_changed(m);
    std::size_t loose = 0;
    for (std::size_t p = touch.own(); p < touch.size(); ++p) {
        if (!touch.is_loose(int(p))) continue;
        ++loose;
        CHECK(touch.meets(int(p)));
        CHECK(touch.points().area(p) == Approx(kA * kA));
        CHECK(m.particle_reference.at(touch.points().corner(p)[0]).x() == Approx(0.15));
    }
    CHECK(loose == 4);
    // And a step back makes all of it whole again.
    for (ConnectionArrays& all : m.connection) {
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            if (all.weight[p] <= 0) all.weight.set(p, 1);
        }
    }
    touch.connections_changed(m);
    for (std::size_t p = 0; p < touch.size(); ++p) CHECK(touch.meets(int(p)) == (p < touch.own()));
}
