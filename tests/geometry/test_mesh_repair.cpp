// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <random>

#include "base/error.h"
#include "base/log.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_edit.h"
#include "geometry/mesh_repair.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::append;
using test::ball_mesh;
using test::box_mesh;
using test::told;

namespace {

std::string refusal(const TriMesh& mesh) {
    try {
        const Repair repair = repair_mesh(mesh);
        for (const std::string& line : repair.account) UNSCOPED_INFO(line);
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::mesh);
        return error.what();
    }
    return {};
}

void drop(TriMesh& mesh, std::initializer_list<int> triangles) {
    std::vector<char> keep(mesh.triangle.size(), 1);
    for (const int t : triangles) keep[t] = 0;
    keep_triangles(mesh, keep);
}

}  // namespace

TEST_CASE("a good mesh comes out of repair untouched") {
    TriMesh ball = ball_mesh(10, 0.3);
    smooth_by_crease_angle(ball, 0.7);
    const Repair repair = repair_mesh(ball);
    CHECK(repair.account.empty());
    CHECK(repair.mesh.triangle == ball.triangle);
    CHECK(repair.mesh.position == ball.position);
    CHECK(repair.mesh.triangle_uv == ball.triangle_uv);
}

TEST_CASE("what bounds its true volume comes out of repair untouched") {
    TriMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    // A label, given from both sides; a triangle without area; a vertex that nothing uses.
    mesh.triangle.push_back({0, 0, 1});
    TriMesh label;
    label.position = {{2, 0, 0}, {3, 0, 0}, {2, 1, 0}};
    label.triangle = {{0, 1, 2}, {0, 2, 1}};
    append(mesh, label);
    mesh.position.push_back({5, 5, 5});
    const Repair repair = repair_mesh(mesh);
    CHECK(repair.account.empty());
    CHECK(repair.mesh.triangle == mesh.triangle);
    CHECK(repair.mesh.position == mesh.position);
}

TEST_CASE("a hole is filled, and all that stood keeps its attributes") {
    TriMesh ball = ball_mesh(10, 0.3);
    smooth_by_crease_angle(ball, 0.7);
    const double volume = signed_volume(ball);
    drop(ball, {40, 41, 42, 43, 44, 45});
    const Repair repair = repair_mesh(ball);
    CHECK(told(repair, "closed"));
    CHECK(check_mesh(repair.mesh).bounds_a_volume());
    CHECK(check_mesh(repair.mesh).manifold);
    CHECK(signed_volume(repair.mesh) == Approx(volume).epsilon(0.02));
    const std::size_t kept = ball.triangle.size();
    REQUIRE(repair.mesh.triangle.size() > kept);
    for (std::size_t t = 0; t < kept; ++t) {
        CHECK(repair.mesh.triangle[t] == ball.triangle[t]);
        CHECK(repair.mesh.triangle_uv[t] == ball.triangle_uv[t]);
    }
    CHECK(repair.mesh.triangle_material.size() == repair.mesh.triangle.size());
    CHECK(repair.mesh.triangle_smooth.size() == repair.mesh.triangle.size());
    for (const Vec3& n : smooth_normals(repair.mesh, repair.mesh.position))
        CHECK(n.norm() == Approx(1));
}

TEST_CASE("a hole is filled around a triangle that stands on corners of its rim") {
    TriMesh ball = ball_mesh(10, 0.3);
    smooth_by_crease_angle(ball, 0.7);
    const double volume = signed_volume(ball);
    // It keeps no edge in common with the rest, and at most one of its corners to itself.
    const Corners alone = ball.triangle[100];
    const int freed = GENERATE_COPY(-1, alone[0], alone[1], alone[2]);
    std::vector<char> keep(ball.triangle.size(), 1);
    for (std::size_t t = 0; t < keep.size(); ++t) {
        const Corners& c = ball.triangle[t];
        const auto common = std::ranges::count_if(
            c, [&](int v) { return std::ranges::find(alone, v) != alone.end(); });
        const bool is_freed = std::ranges::find(c, freed) != c.end();
        keep[t] = t == 100 || (common < 2 && !is_freed);
    }
    keep_triangles(ball, keep);
    const Repair repair = repair_mesh(ball);
    CHECK(told(repair, "left out 1 open sheet of 1 triangle"));
    CHECK_FALSE(told(repair, "wrapped"));
    CHECK(repair.mesh.triangle_uv.size() == repair.mesh.triangle.size());
    CHECK(check_mesh(repair.mesh).bounds_a_volume());
    CHECK(signed_volume(repair.mesh) == Approx(volume).epsilon(0.02));
}

TEST_CASE("an open box is closed to its true volume; two holes are two fillings") {
    TriMesh box = box_mesh({0, 0, 0}, {1, 2, 3});
    drop(box, {0, 1, 2, 3});  // bottom and top
    const Repair repair = repair_mesh(box);
    CHECK(told(repair, "closed 2 holes, 8 edges in total, with 4 triangles, 18 % of the surface"));
    CHECK(signed_volume(repair.mesh) == Approx(6));
}

TEST_CASE("of a sheet the smaller number of triangles is turned, whichever comes first") {
    for (const std::size_t wrong : {0, 7}) {
        TriMesh box = box_mesh({0, 0, 0}, {1, 2, 3});
        flip_triangle(box, wrong);
        const Repair repair = repair_mesh(box);
        CHECK(repair.account ==
              std::vector<std::string>{"turned 1 triangle to agree with their neighbours"});
        CHECK(signed_volume(repair.mesh) == Approx(6));
    }
}

TEST_CASE("triangles turned at random are turned back") {
    TriMesh ball = ball_mesh(12, 1);
    const double volume = signed_volume(ball);
    std::mt19937 random(7);
    for (std::size_t t = 0; t < ball.triangle.size(); ++t)
        if (random() % 2) flip_triangle(ball, t);
    const Repair repair = repair_mesh(ball);
    CHECK(told(repair, "agree with their neighbours"));
    CHECK(signed_volume(repair.mesh) == Approx(volume));
    // Texture coordinates turned with their triangles.
    for (std::size_t t = 0; t < repair.mesh.triangle.size(); ++t)
        CHECK(repair.mesh.triangle[t] == repair.mesh.triangle_uv[t]);
}

namespace {

// Each triangle with corners of its own, moved by up to half of `jitter`.
TriMesh soup_of(const TriMesh& mesh, double jitter) {
    TriMesh soup;
    std::mt19937 random(3);
    const auto moved = [&] { return jitter * (random() / 4294967296.0 - 0.5); };
    for (const Corners& t : mesh.triangle) {
        const int base = static_cast<int>(soup.position.size());
        for (const int i : t)
            soup.position.push_back(mesh.position[i] + Vec3(moved(), moved(), moved()));
        soup.triangle.push_back({base, base + 1, base + 2});
    }
    return soup;
}

}  // namespace

TEST_CASE("a soup of unwelded, slightly jittered triangles is stitched") {
    TriMesh ball = ball_mesh(8, 1);
    const double volume = signed_volume(ball);
    const Repair repair = repair_mesh(soup_of(ball, 1e-7));
    CHECK(told(repair, "stitched"));
    CHECK(check_mesh(repair.mesh).manifold);
    CHECK(signed_volume(repair.mesh) == Approx(volume));

    // Triangles as thin as the jitter, and much thinner and thicker ones.
    for (const double thin : {1e-9, 1e-7, 3e-6}) {
        TriMesh cut = ball_mesh(8, 1);
        for (const std::size_t t : {7, 40, 41, 90}) {
            // A corner close to one of the edge's ends, in both triangles at the edge.
            const int a = cut.triangle[t][0], b = cut.triangle[t][1];
            const int m = static_cast<int>(cut.position.size());
            const Vec3 along = cut.position[b] - cut.position[a];
            cut.position.push_back(cut.position[a] + thin * along.normalized());
            for (std::size_t n = 0, count = cut.triangle.size(); n < count; ++n)
                for (int k = 0; k < 3; ++k) {
                    const Corners c = cut.triangle[n];
                    const int from = c[k], to = c[(k + 1) % 3], apex = c[(k + 2) % 3];
                    if (std::minmax(from, to) != std::minmax(a, b)) continue;
                    cut.triangle[n] = {from, m, apex};
                    cut.triangle.push_back({m, to, apex});
                    break;
                }
        }
        const Repair mended = repair_mesh(soup_of(cut, 1e-7));
        CHECK(told(mended, "became 0"));
        CHECK(!told(mended, "wrapped"));
        CHECK(check_mesh(mended.mesh).bounds_a_volume());
        CHECK(signed_volume(mended.mesh) == Approx(volume));
    }
}

TEST_CASE("a surface given twice in the same places, facing the same way, counts once") {
    TriMesh ball = ball_mesh(10, 0.3);
    const TriMesh once = ball;
    append(ball, box_mesh({1, 0, 0}, {2, 1, 1}));
    ball.triangle_uv.clear();
    ball.triangle_material.clear();
    for (const bool inside_out : {false, true}) {
        TriMesh mesh = ball;
        mesh.triangle.insert(mesh.triangle.end(), once.triangle.begin(), once.triangle.end());
        if (inside_out)
            for (Corners& t : mesh.triangle) std::swap(t[0], t[1]);
        CHECK(!check_mesh(mesh).is_one_body());
        const Repair repair = repair_mesh(mesh);
        CHECK(told(repair, "given more than once"));
        CHECK(repair.mesh.triangle.size() == ball.triangle.size());
        CHECK(signed_volume(repair.mesh) == Approx(1 + signed_volume(once)));
    }
    TriMesh alone = once;
    alone.triangle.insert(alone.triangle.end(), once.triangle.begin(), once.triangle.end());
    alone.triangle_uv.clear();
    alone.triangle_material.clear();
    CHECK(!check_mesh(alone).is_one_body());
    CHECK(signed_volume(repair_mesh(alone).mesh) == Approx(signed_volume(once)));
}

namespace {

// Along x, of quads; open at both ends.
TriMesh tube_mesh(double length, double radius, int around, int rings) {
    TriMesh mesh;
    for (int r = 0; r <= rings; ++r)
        for (int a = 0; a < around; ++a) {
            const double turn = 2 * kPi * a / around;
            mesh.position.emplace_back(length * r / rings, radius * std::cos(turn),
                                       radius * std::sin(turn));
        }
    for (int r = 0; r < rings; ++r)
        for (int a = 0; a < around; ++a) {
            const int i = around * r + a, j = around * r + (a + 1) % around;
            mesh.triangle.push_back({i, i + around, j});
            mesh.triangle.push_back({j, i + around, j + around});
        }
    return mesh;
}

double tube_volume(double length, double radius, int around) {
    return length * 0.5 * around * radius * radius * std::sin(2 * kPi / around);
}

}  // namespace

TEST_CASE("a rim of edges shorter than any gap keeps its width") {
    for (const int around : {8, 48, 200}) {
        const TriMesh wire = tube_mesh(1, 5e-4, around, 10);
        const Repair repair = repair_mesh(wire);
        CHECK(told(repair, "closed 2 holes"));
        CHECK(signed_volume(repair.mesh) == Approx(tube_volume(1, 5e-4, around)));
        CHECK(repair.mesh.position.size() == wire.position.size());
    }
    // One thinner than the widest gap.
    CHECK(signed_volume(repair_mesh(tube_mesh(1, 4e-5, 6, 4)).mesh) ==
          Approx(tube_volume(1, 4e-5, 6)));
    CHECK(signed_volume(repair_mesh(soup_of(tube_mesh(1, 4e-5, 6, 4), 1e-9)).mesh) ==
          Approx(tube_volume(1, 4e-5, 6)).epsilon(1e-3));
    // A wide one, finely divided.
    CHECK(signed_volume(repair_mesh(tube_mesh(1, 0.5, 12000, 1)).mesh) ==
          Approx(tube_volume(1, 0.5, 12000)));
}

TEST_CASE("fine rims that face each other across a crack are stitched, corner to corner") {
    TriMesh wire = tube_mesh(1, 5e-4, 48, 10);
    append(wire, tube_mesh(1, 5e-4, 48, 10));
    const std::size_t half = wire.position.size() / 2;
    for (std::size_t i = half; i < wire.position.size(); ++i)
        wire.position[i] += Vec3(1 + 3e-6, 1e-6 * std::sin(i), 0);
    const Repair repair = repair_mesh(wire);
    CHECK(told(repair, "stitched 48 vertices"));
    CHECK(told(repair, "closed 2 holes"));
    CHECK(check_mesh(repair.mesh).components == 1);
    CHECK(check_mesh(repair.mesh).manifold);
    CHECK(signed_volume(repair.mesh) == Approx(tube_volume(2, 5e-4, 48)).epsilon(1e-4));
}

TEST_CASE("a slit, whose two sides are one border, is stitched to its ends") {
    TriMesh ball = ball_mesh(16, 1);
    const std::size_t triangles = ball.triangle.size();
    const double volume = signed_volume(ball);
    // Down a meridian: triangles on one side get corners of their own.
    const int around = 32;
    std::vector<int> other(ball.position.size(), -1);
    for (int r = 4; r < 13; ++r) {
        const int i = 1 + (r - 1) * around;
        other[i] = static_cast<int>(ball.position.size());
        ball.position.push_back(ball.position[i] + Vec3(1e-6, 2e-6, 1e-6 * r));
    }
    for (Corners& t : ball.triangle) {
        double aside = 0;
        for (const int i : t) aside += ball.position[i].y();
        if (aside < 0)
            for (int& i : t)
                if (i < static_cast<int>(other.size()) && other[i] >= 0) i = other[i];
    }
    ball.uv.clear();
    ball.triangle_uv.clear();
    REQUIRE(check_mesh(ball).boundary_edges == 20);
    const Repair repair = repair_mesh(ball);
    CHECK(told(repair, "stitched 9 vertices"));
    CHECK(told(repair, "20 border edges became 0"));
    CHECK(repair.mesh.triangle.size() == triangles);
    CHECK(signed_volume(repair.mesh) == Approx(volume).epsilon(1e-4));
}

TEST_CASE("an inside-out body is turned, and said") {
    const Repair repair = repair_mesh(box_mesh({0, 0, 0}, {1, 1, 1}, true));
    CHECK(told(repair, "inside out"));
    CHECK(signed_volume(repair.mesh) == Approx(1));
}

TEST_CASE("a cavity stays a cavity; a hollow body inside out is turned with it") {
    TriMesh hollow = box_mesh({0, 0, 0}, {3, 3, 3});
    append(hollow, box_mesh({1, 1, 1}, {2, 2, 2}, true));
    const Repair good = repair_mesh(hollow);
    CHECK(good.account.empty());
    CHECK(signed_volume(good.mesh) == Approx(26));

    TriMesh inverted = box_mesh({0, 0, 0}, {3, 3, 3}, true);
    append(inverted, box_mesh({1, 1, 1}, {2, 2, 2}));
    const Repair turned = repair_mesh(inverted);
    CHECK(told(turned, "inside out"));
    CHECK(signed_volume(turned.mesh) == Approx(26));

    // An island in the cavity is matter again.
    append(hollow, box_mesh({1.25, 1.25, 1.25}, {1.75, 1.75, 1.75}));
    const Repair island = repair_mesh(hollow);
    CHECK(island.account.empty());
    CHECK(signed_volume(island.mesh) == Approx(26.125));
}

namespace {

// Square rods along the diagonal of space, 4 mm from middle to middle and 2 mm wide.
TriMesh oblique_rods(int count) {
    const Mat3 turn = turn_onto(Vec3::UnitZ(), Vec3::Ones()).toRotationMatrix();
    TriMesh rods;
    for (int n = 0; n < count; ++n) {
        const Vec3 low(0.004 * (n % 11), 0.004 * (n / 11), 0);
        append(rods, box_mesh(low, low + Vec3(0.002, 0.002, 0.3)));
    }
    for (Vec3& p : rods.position) p = turn * p;
    return rods;
}

}  // namespace

TEST_CASE("bodies that do not touch stay apart, however many lie in each other's boxes") {
    const int count = 105;
    TriMesh rods = oblique_rods(count);
    const double volume = signed_volume(rods);
    REQUIRE(volume == Approx(count * 1.2e-6));
    drop(rods, {0, 1});  // an end
    const Repair repair = repair_mesh(rods);
    REQUIRE(repair.account.size() == 1);
    CHECK(told(repair, "closed 1 hole"));
    CHECK(signed_volume(repair.mesh) == Approx(volume));
    CHECK(check_mesh(repair.mesh).components == count);
}

TEST_CASE("every face given twice, back to back, becomes one closed surface") {
    TriMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
    const TriMesh back = box_mesh({0, 0, 0}, {1, 1, 1}, true);
    box.triangle.insert(box.triangle.end(), back.triangle.begin(), back.triangle.end());
    const Repair repair = repair_mesh(box);
    CHECK(told(repair, "duplicate"));
    CHECK(signed_volume(repair.mesh) == Approx(1));
}

TEST_CASE("of a wall given three times as many triangles are told as are left out") {
    TriMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    TriMesh wall;
    wall.position = {{2, 0, 0}, {3, 0, 0}, {2, 1, 0}};
    wall.triangle = {{0, 1, 2}, {0, 2, 1}, {0, 1, 2}};
    append(mesh, wall);
    const Repair repair = repair_mesh(mesh);
    CHECK(told(repair, "left out 3 triangles of inner walls"));
    CHECK(repair.mesh.triangle.size() == 12);
}

TEST_CASE("an open sheet is refused with what to do; beside a body it is left out") {
    TriMesh sheet;
    for (int y = 0; y <= 10; ++y)
        for (int x = 0; x <= 10; ++x)
            sheet.position.emplace_back(0.1 * x, 0.1 * y, 0.02 * std::sin(0.5 * x));
    for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 10; ++x) {
            const int a = 11 * y + x;
            sheet.triangle.push_back({a, a + 1, a + 12});
            sheet.triangle.push_back({a, a + 12, a + 11});
        }
    CHECK(refusal(sheet).find("thickness") != std::string::npos);

    TriMesh both = sheet;
    append(both, box_mesh({0, 0, -5}, {3, 3, -2}));
    for (const Vec3& p : both.position) both.position_color.push_back(p.cast<float>());
    const Repair repair = repair_mesh(both);
    for (std::size_t i = 0; i < repair.mesh.position.size(); ++i) {
        CHECK(repair.mesh.position_color.at(i) == repair.mesh.position[i].cast<float>());
    }
    CHECK(told(repair, "left out 1 open sheet"));
    CHECK(signed_volume(repair.mesh) == Approx(27));
    CHECK(repair.mesh.position.size() == 8);  // nothing stray is left to spoil the box

    // Up to a quarter of all area.
    for (const double size : {1.2, 1.8}) {
        TriMesh large = sheet;
        for (Vec3& p : large.position) p *= size;
        TriMesh beside = box_mesh({0, 0, -5}, {1, 1, -4});
        append(beside, large);
        const std::string reason = refusal(beside);
        CHECK((reason.find("thickness") != std::string::npos) == (size > 1.5));
    }

    TriMesh double_sided = sheet;
    for (Corners t : sheet.triangle) {
        std::swap(t[0], t[1]);
        double_sided.triangle.push_back(t);
    }
    CHECK(refusal(double_sided).find("thickness") != std::string::npos);
    CHECK(!refusal(TriMesh{}).empty());
    TriMesh needle;  // its ends are within the widest gap
    needle.position = {{0, 0, 0}, {1, 0, 0}, {1, 1e-5, 0}};
    needle.triangle = {{0, 1, 2}};
    CHECK(refusal(needle).find("cannot be given a volume") != std::string::npos);
}

TEST_CASE("what cannot be oriented is wrapped as a last resort, and its losses named") {
    set_log_level(LogLevel::quiet);
    // A ball with a fin: three triangles at the fin's root.
    TriMesh ball = ball_mesh(12, 1);
    const Corners root = ball.triangle[50];
    ball.position.push_back(1.2 * ball.position[root[0]]);
    const int tip = static_cast<int>(ball.position.size()) - 1;
    ball.triangle.push_back({root[0], root[1], tip});
    ball.triangle_uv.push_back({0, 0, 0});
    ball.triangle_material.push_back(0);
    const Repair repair = repair_mesh(ball);
    set_log_level(LogLevel::normal);
    CHECK(told(repair, "wrapped"));
    CHECK(told(repair, "are lost"));
    CHECK(check_mesh(repair.mesh).bounds_a_volume());
    CHECK(signed_volume(repair.mesh) == Approx(4.1).epsilon(0.05));
    CHECK(repair.mesh.triangle_uv.empty());
}

TEST_CASE("random damage is either repaired to a closed volume or refused") {
    set_log_level(LogLevel::quiet);
    std::mt19937 random(11);
    int repaired = 0;
    for (int round = 0; round < 12; ++round) {
        TriMesh ball = ball_mesh(8, 1);
        const double volume = signed_volume(ball);
        std::vector<char> keep(ball.triangle.size(), 1);
        for (int i = 0; i < 4; ++i) keep[random() % keep.size()] = 0;
        keep_triangles(ball, keep);
        for (int i = 0; i < 20; ++i) flip_triangle(ball, random() % ball.triangle.size());
        try {
            const Repair repair = repair_mesh(ball);
            CHECK(check_mesh(repair.mesh).bounds_a_volume());
            CHECK(signed_volume(repair.mesh) == Approx(volume).epsilon(0.1));
            CHECK(!repair.account.empty());
            ++repaired;
        } catch (const Error&) {
        }
    }
    set_log_level(LogLevel::normal);
    CHECK(repaired == 12);
}
