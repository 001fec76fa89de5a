// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts that stop inside a body, and cuts through what others have left.
#include <algorithm>
#include <random>

#include "geometry/triangle_tree.h"
#include "tests/skin/cut_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

// How far apart vertices of one part of the surface have moved. 0: none goes with another piece.
double most_torn(const TriMesh& mesh, const std::vector<Vec3>& before,
                 const std::vector<Vec3>& after) {
    const Components parts = surface_components(mesh);
    const Vec3 none = Vec3::Constant(1e9);
    std::vector<Vec3> low(parts.count, none), high(parts.count, -none);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const int part = parts.triangle_component[t];
        for (const int v : mesh.triangle[t]) {
            low[part] = low[part].cwiseMin(after[v] - before[v]);
            high[part] = high[part].cwiseMax(after[v] - before[v]);
        }
    }
    double most = 0;
    for (int part = 0; part < parts.count; ++part) {
        most = std::max(most, (high[part] - low[part]).norm());
    }
    return most;
}

// A bar, and under it a rod along it.
TriMesh bar_with_rod(double low, double high, double thickness) {
    TriMesh mesh = bar();
    const int first = static_cast<int>(mesh.position.size());
    const TriMesh rod =
        box_mesh({.5 * (high - low), .5 * thickness, .5 * thickness}, {9, 2, 2}, false);
    for (const Vec3& p : rod.position) {
        mesh.position.push_back(p + Vec3(.5 * (low + high), -.16 - .5 * thickness, 0));
    }
    for (const Corners& t : rod.triangle) {
        mesh.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return mesh;
}

// Where a blade at each of `x` has parted the bar, what lies beyond it goes 1 m along.
void part_at(Fixture& f, const std::vector<double>& x) {
    for (const double at : x) test::sever_plane(f.matter, {at, 0, 0}, Vec3::UnitX());
    test::deform(f.matter, [&](const Vec3& p) -> Vec3 {
        Vec3 to = p;
        for (const double at : x) to.x() += p.x() > at;
        return to;
    });
    f.follow();
}

}  // namespace

TEST_CASE("a blade that stops inside the body leaves the surface in one piece") {
    Fixture f(bar());
    const double whole = signed_volume(f.mesh);
    // From above down to y = 0.0161, through the whole depth.
    const Vec3 a(0.0137, .0161, -1), b(0.0137, .0161, 1), c(0.0137, 1, 1), d(0.0137, 1, -1);
    const CutResult result = f.cut({{a, b, c}, {a, c, d}});
    CHECK(result.cuts == 1);
    CHECK(cap_triangles(f.mesh) > 0);
    CHECK(parts_of(f.mesh).size() == 1);
    CHECK(test::is_closed(f.mesh));
    CHECK(signed_volume(f.mesh) == Approx(whole).epsilon(1e-9));
    // It opens like a mouth when the matter does.
    test::sever_plane(f.matter, {0.0137, 0, 0}, Vec3::UnitX(),
                      [](const Vec3& p) { return p.y() > .0161; });
    test::deform(f.matter, [](const Vec3& p) -> Vec3 {
        const double open = .2 * std::max(0., p.y() - .0161);
        return p + Vec3(p.x() > .0137 ? open : -open, 0, 0);
    });
    f.follow();
    TriMesh opened = f.mesh;
    opened.position = f.position;
    // The map moves each half along x by what depends on y alone: no volume is made.
    CHECK(signed_volume(opened) == Approx(whole).epsilon(2e-3));
    double low = 1e9, high = -1e9;
    for (std::size_t v = 0; v < f.position.size(); ++v) {
        if (std::abs(f.mesh.position[v].x() - .0137) > 1e-6) continue;
        low = std::min(low, f.position[v].x());
        high = std::max(high, f.position[v].x());
    }
    CHECK(high - low == Approx(2 * .2 * (.15 - .0161)).epsilon(.05));
}

TEST_CASE("faces of a cut are of the part that they cut through, and shade apart where they meet") {
    Fixture f(bar());
    f.mesh.part_name = {"another", "bar"};
    for (int& part : f.mesh.triangle_part) part = 1;
    const Vec3 a(0.0137, .0161, -1), b(0.0137, .0161, 1), c(0.0137, 1, 1), d(0.0137, 1, -1);
    f.cut({{a, b, c}, {a, c, d}});
    std::set<int> vertex[2], group[2];  // of the faces on either side
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        CHECK(f.mesh.triangle_part[t] == 1);
        if (!is_cut_look(f.mesh.material[f.mesh.triangle_material[t]])) continue;
        const int side = area_vector(f.mesh.position, f.mesh.triangle[t]).x() > 0;
        for (int v : f.mesh.triangle[t]) vertex[side].insert(v);
        for (int g : f.mesh.triangle_smooth[t]) group[side].insert(g);
    }
    const auto common = [](const std::set<int>* of) {
        return std::ranges::count_if(of[0], [&](int one) { return of[1].contains(one); });
    };
    CHECK(common(vertex) > 0);  // where the blade stops
    CHECK(common(group) == 0);
}

TEST_CASE("wherever a blade stops, no triangle or edge is its own other side") {
    std::mt19937 random(7);
    const auto at_random = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    // A blade that falls in steps and rises in others.
    const auto slit = [](const Vec3& from, const Vec3& edge, const Vec3& fall, int down, int up) {
        Sweep sweep;
        for (int way = 0; way < 2; ++way) {
            const int steps = way == 0 ? down : up;
            for (int n = 0; n < steps; ++n) {
                const double s0 = double(n) / steps, s1 = double(n + 1) / steps;
                const Vec3 a = from + (way == 0 ? s0 : 1 - s0) * fall;
                const Vec3 b = from + (way == 0 ? s1 : 1 - s1) * fall;
                sweep.push_back({a, a + edge, b + edge});
                sweep.push_back({a, b + edge, b});
            }
        }
        return sweep;
    };
    for (int n = 0; n < 60; ++n) {
        CAPTURE(n);
        Fixture f(bar(n % 3 == 0));
        const double whole = signed_volume(f.mesh);
        const Vec3 across = (Vec3::UnitZ() + at_random(-.3, .3) * Vec3::UnitX()).normalized();
        const Vec3 fall(at_random(-.1, .1), -at_random(.05, .3), 0);
        const double width = at_random(.002, .25);
        const Vec3 from(at_random(-.2, .2), .17, at_random(-.18, .15));
        f.cut(slit(from, width * across, fall, 1 + n % 5, 1 + n % 7));
        check_sound(f.mesh, f.mesh.position);
        CHECK(signed_volume(f.mesh) == Approx(whole).epsilon(1e-9));
        std::set<std::pair<int, int>> seen;
        for (const Corners& t : f.mesh.triangle) {
            for (int k = 0; k < 3; ++k) CHECK(seen.insert({t[k], t[(k + 1) % 3]}).second);
        }
    }
}

TEST_CASE("two blades cut four closed parts out of a bar") {
    Fixture f(bar());
    const double whole = signed_volume(f.mesh);
    Sweep both = sweep_of({.013, 0, 0}, Vec3(1, .2, 0).normalized(), 3);
    for (const auto& t : sweep_of({.01, .0071, 0}, Vec3(0, 1, .1).normalized(), 3.3)) {
        both.push_back(t);
    }
    const CutResult result = f.cut(both);
    CHECK(result.cuts == 2);
    check_sound(f.mesh, f.position);
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    CHECK(parts.size() == 4);
    double sum = 0;
    for (const TriMesh& part : parts) sum += signed_volume(part);
    CHECK(sum == Approx(whole).epsilon(1e-9));
}

TEST_CASE("what a blade only touches stays whole, on whichever side of it") {
    const double x = .0137;
    for (const double beyond : {-1e-5, 0., 1e-5}) {
        for (const int way : {-1, 1}) {
            INFO(beyond << " beyond, from " << way);
            TriMesh mesh = bar();
            for (Vec3& p : mesh.position) p.y() *= .5;
            const int first = static_cast<int>(mesh.position.size());
            // Above the bar a thorn, whose tip is at the blade.
            mesh.position.insert(mesh.position.end(),
                                 {Vec3(x + way * beyond, .1, 0), Vec3(x - way * .08, .09, -.02),
                                  Vec3(x - way * .08, .13, 0), Vec3(x - way * .08, .09, .02)});
            for (Corners t : {Corners{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}) {
                if (way < 0) std::swap(t[1], t[2]);
                mesh.triangle.push_back({first + t[0], first + t[1], first + t[2]});
            }
            Fixture f(std::move(mesh));
            const Vec3 p(x, 0, 0);
            f.cut(sweep_of(p, Vec3::UnitX(), 3));
            check_sound(f.mesh, f.position);
            REQUIRE(surface_components(f.mesh).count == 3);
            const std::vector<Vec3> before = f.position;
            test::sever_plane(f.matter, p, Vec3::UnitX());
            test::deform(f.matter, [&](const Vec3& at) -> Vec3 {
                return at + Vec3(at.x() > x ? 1 : 0, 0, 0);
            });
            f.follow();
            CHECK(most_torn(f.mesh, before, f.position) < 1e-12);
        }
    }
}

TEST_CASE("chips of several blades stay together with what the first of them is cut from") {
    for (const bool is_left_first : {false, true}) {
        CAPTURE(is_left_first);
        Fixture f(bar_with_rod(-.025, .1, .04));
        std::vector<double> x = {.02, -.02};
        if (is_left_first) std::swap(x[0], x[1]);
        Sweep both = sweep_of({x[0], 0, 0}, Vec3::UnitX(), 3);
        for (const auto& t : sweep_of({x[1], 0, 0}, Vec3::UnitX(), 3.3)) both.push_back(t);
        REQUIRE(f.cut(both).cuts == 2);
        REQUIRE(parts_of(f.mesh).size() == 6);
        const std::vector<Vec3> before = f.position;
        part_at(f, x);
        CHECK(most_torn(f.mesh, before, f.position) < 1e-12);
        for (std::size_t v = 0; v < before.size(); ++v) {
            if (before[v].y() < -.155) CHECK(f.position[v].x() - before[v].x() == Approx(2));
        }
    }
}

TEST_CASE("what is cut off thin but longer than a cell goes with its own side") {
    Fixture f(bar_with_rod(-.04, .2, .02));
    REQUIRE(f.cut(sweep_of({.02, 0, 0}, Vec3::UnitX(), 3)).cuts == 1);
    const std::vector<Vec3> before = f.position;
    part_at(f, {.02});
    CHECK(most_torn(f.mesh, before, f.position) < 1e-12);
    for (std::size_t v = 0; v < before.size(); ++v) {
        if (before[v].x() < .019) CHECK(f.position[v].x() == before[v].x());
    }
}

TEST_CASE("what two blades cut follows its own piece, one after another or at once") {
    const Vec3 n1 = Vec3::UnitX(), slanted = Vec3(0.1, 1, .1).normalized();
    // Beside layers of particles, and along them.
    for (const double x : {.0137, 0.0, 0.1}) {
        for (const auto& [y, n2] : {std::pair(.0071, slanted), std::pair(0.0, Vec3(Vec3::UnitY())),
                                    std::pair(-0.05, Vec3(Vec3::UnitY()))}) {
            for (const bool at_once : {false, true}) {
                INFO(x << ", " << y << " across " << n2.transpose()
                       << (at_once ? ", at once" : ""));
                Fixture f(bar());
                const Vec3 p1(x, 0, 0), p2(0, y, 0);
                if (at_once) {
                    Sweep both = sweep_of(p1, n1, 3);
                    for (const auto& t : sweep_of(p2, n2, 3.3)) both.push_back(t);
                    f.cut(both);
                    test::sever_plane(f.matter, p1, n1);
                } else {
                    f.cut(sweep_of(p1, n1, 3));
                    test::sever_plane(f.matter, p1, n1);
                    f.cut(sweep_of(p2, n2, 3));
                }
                test::sever_plane(f.matter, p2, n2);
                REQUIRE(find_pieces(f.matter).count == 4);
                check_sound(f.mesh, f.position);
                REQUIRE(surface_components(f.mesh).count == 4);
                const std::vector<Vec3> before = f.position;
                const Vec3 beside = 1e-6 * f.matter.lattice.spacing * Vec3(1.3, 1.7, 0.9);
                const auto shift = [&](const Vec3& p) -> Vec3 {
                    return Vec3(n1.dot(p - p1 - beside) >= 0 ? 1 : 0,
                                n2.dot(p - p2 - beside) >= 0 ? 1 : 0, 0);
                };
                test::deform(f.matter, [&](const Vec3& p) -> Vec3 { return p + shift(p); });
                f.follow();
                CHECK(most_torn(f.mesh, before, f.position) < 1e-12);
            }
        }
    }
}

TEST_CASE(
    "a second cut goes through the faces of the first as they are, however the matter flowed") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> noise(-.2 * .05, .2 * .05);
    for (int n = 0; n < 8; ++n) {
        CAPTURE(n);
        Fixture f(bar());
        const Vec3 p1(0.0137, 0, 0), n1 = Vec3(1, .3, .1 * n).normalized();
        f.cut(sweep_of(p1, n1, 3));
        test::sever_plane(f.matter, p1, n1);
        f.matter.cell_history.hardening().assign(f.matter.cell_fill.size(), 1);
        test::deform(f.matter, [&](const Vec3& p) -> Vec3 {
            return p + Vec3(noise(random), noise(random), noise(random));
        });
        f.follow();
        TriMesh before = f.mesh;
        before.position = f.position;
        double longest = 0;
        for (const Corners& t : before.triangle) {
            for (int k = 0; k < 3; ++k) {
                const Vec3 edge = f.position[t[k]] - f.position[t[(k + 1) % 3]];
                longest = std::max(longest, edge.norm());
            }
        }
        const TriangleTree surface(before);
        f.cut(sweep_of({0, .0071, 0}, Vec3(.1, 1, .1).normalized(), 3));
        REQUIRE(cap_triangles(f.mesh) > 0);
        // Between its ends an edge leaves its chord by a tenth of its length at most. Caps come
        // last.
        const std::size_t end = f.mesh.triangle.size() - cap_triangles(f.mesh);
        double worst = 0;
        for (std::size_t t = 0; t < end; ++t) {
            for (int v : f.mesh.triangle[t]) {
                if (v < static_cast<int>(before.position.size())) continue;
                worst = std::max(worst, surface.distance(f.position[v]));
            }
        }
        CHECK(worst < .1 * longest);
    }
}
