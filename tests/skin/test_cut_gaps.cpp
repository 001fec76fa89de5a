// SPDX-License-Identifier: GPL-3.0-or-later
// Blades that pass between parts of a surface, in gaps that the matter does not know.
#include <random>

#include "matter/aggregate.h"
#include "skin/whole_parts.h"
#include "tests/skin/cut_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

void add_box(TriMesh& mesh, const Vec3& low, const Vec3& high, const Vec3i& division) {
    const TriMesh box = box_mesh(.5 * (high - low), division, false);
    const int first = static_cast<int>(mesh.position.size());
    for (const Vec3& p : box.position) mesh.position.push_back(p + .5 * (low + high));
    for (const Corners& t : box.triangle) {
        mesh.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
}

// Boxes from end to end of the fixture's bar, with gaps: each goes from one place to the next.
TriMesh boxes_along(const std::vector<std::array<double, 2>>& from_to, const Vec3i& division) {
    TriMesh mesh;
    for (const auto& [from, to] : from_to) {
        add_box(mesh, {from, -.15, -.15}, {to, .15, .15}, division);
    }
    return mesh;
}

// Every piece of the matter goes a way of its own; how much longer any part of the skin gets.
double most_stretched(Fixture& f) {
    const std::vector<Vec3> before = f.position;
    const Pieces pieces = find_pieces(f.matter);
    for (std::size_t p = 0; p < f.matter.particle_count(); ++p) {
        const double n = pieces.particle_piece[p];
        f.matter.particle_position.set(
            p, f.matter.particle_position.at(p) + Vec3(n, .3 * n * n, std::sin(n)));
    }
    f.follow();
    double most = 0;
    for (const Corners& t : f.mesh.triangle) {
        for (int k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            most =
                std::max(most, ((f.position[a] - before[a]) - (f.position[b] - before[b])).norm());
        }
    }
    return most;
}

}  // namespace

TEST_CASE("what lies on either side of a blade in a gap follows its own side") {
    // Cells go from 0 to 0.05; gaps beside their middle, on it, and on one side of it.
    for (const auto& [from, to] : {std::pair(.01, .02),
                                   {.01, .025},
                                   {.025, .04},
                                   {.0275, .04},
                                   {.024, .026},
                                   {.01, .0101},
                                   {-.02, .03}}) {
        for (const double share : {0.0, .01, .5, .99, 1.0}) {
            const double at = from + share * (to - from);
            CAPTURE(from, to, at);
            Fixture f(boxes_along({{-.5, from}, {to, .5}}, {1, 1, 1}));
            CHECK(f.cut(sweep_of({at, 0, 0}, Vec3::UnitX(), 3)).cuts == 0);
            test::sever_plane(f.matter, {at, 0, 0}, Vec3::UnitX());
            REQUIRE(find_pieces(f.matter).count == 2);
            CHECK(most_stretched(f) < 1e-12);
        }
    }
}

TEST_CASE("a plate whose faces lie in the middle of cells goes from between two blades whole") {
    for (const double thick : {.05, .03, .07}) {  // around one layer of particles
        CAPTURE(thick);
        const double low = -.5 * thick, high = .5 * thick;
        Fixture f(boxes_along({{-.5, low - .01}, {low, high}, {high + .01, .5}}, {1, 2, 2}));
        Sweep both = sweep_of({low - .005, 0, 0}, Vec3::UnitX(), 3);
        for (const auto& t : sweep_of({high + .005, 0, 0}, Vec3::UnitX(), 3.1)) both.push_back(t);
        CHECK(f.cut(both).cuts == 0);
        for (const double x : {low - .005, high + .005}) {
            test::sever_plane(f.matter, {x, 0, 0}, Vec3::UnitX());
        }
        REQUIRE(find_pieces(f.matter).count == 3);
        CHECK(most_stretched(f) < 1e-12);
    }
}

TEST_CASE("what blades pass by, or leave less of than a layer of particles, follows one piece") {
    std::mt19937 random(11);
    const auto at_random = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int n = 0; n < 300; ++n) {
        CAPTURE(n);
        std::vector<std::array<double, 2>> boxes;
        for (double at = -.5; at < .5;) {
            const double to = at + at_random(.005, n % 2 ? .1 : .4);
            boxes.push_back({at, std::min(.5, to)});
            at = to + at_random(.001, .06);
        }
        Fixture f(boxes_along(boxes, Vec3i::Constant(1 + n % 3)));
        const double tilt = n % 5 ? 0 : .3;
        std::vector<std::pair<Vec3, Vec3>> blade;
        Sweep sweep;
        for (int b = 0; b <= n % 4; ++b) {
            const Vec3 at(at_random(-.45, .45), 0, 0);
            const Vec3 along(1, at_random(-tilt, tilt), at_random(-tilt, tilt));
            blade.push_back({at, along.normalized()});
            for (const auto& t : sweep_of(at, along.normalized(), 3 + .01 * b)) sweep.push_back(t);
        }
        f.cut(sweep);
        for (const auto& [at, normal] : blade) test::sever_plane(f.matter, at, normal);
        follow_one_piece(f.mesh, f.mount, f.matter);
        f.follow();
        CHECK(most_stretched(f) < 1e-9);
    }
}

TEST_CASE("a part that a blade reaches only by the cells it shares stays in one piece") {
    // Under the bar a rod along it, in the same layer of cells; the blade stops between the two.
    TriMesh mesh = boxes_along({{-.5, .5}}, {8, 2, 2});
    for (Vec3& p : mesh.position) p.y() = std::max(p.y(), -.1);
    add_box(mesh, {.2, -.145, -.15}, {.5, -.11, .15}, {3, 1, 1});
    add_box(mesh, {-.2, -.145, -.15}, {.03, -.11, .15}, {3, 1, 1});
    Fixture f(std::move(mesh));
    const Vec3 a(.0137, -.105, -1), b(.0137, -.105, 1), c(.0137, 1, 1), d(.0137, 1, -1);
    CHECK(f.cut({{a, b, c}, {a, c, d}}).cuts == 1);
    test::sever_plane(f.matter, {.0137, 0, 0}, Vec3::UnitX());
    follow_one_piece(f.mesh, f.mount, f.matter);
    f.follow();
    const Components parts = surface_components(f.mesh);
    REQUIRE(parts.count == 4);
    CHECK(most_stretched(f) < 1e-12);
}
