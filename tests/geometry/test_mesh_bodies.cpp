// SPDX-License-Identifier: GPL-3.0-or-later
// What the repair makes of bodies that cross, touch and lie in each other.
#include "geometry/crease_angle.h"
#include "geometry/mesh_bodies.h"

#include <Eigen/Geometry>
#include <map>
#include <random>
#include <set>

#include "geometry/mesh_check.h"
#include "geometry/mesh_repair.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::append;
using test::box_mesh;
using test::told;

namespace {

// Boxes in a row, each 0.2 into the next and a little aside of it.
TriMesh chain(const std::vector<int>& order) {
    TriMesh mesh;
    for (const int n : order) {
        const Vec3 low(n, 0.1 * (n % 3), 0.1 * (n % 2));
        append(mesh, box_mesh(low, low + Vec3(1.2, 1, 1)));
    }
    return mesh;
}

double chain_volume(int count) {
    double volume = 1.2 * count;
    for (int n = 0; n + 1 < count; ++n)
        volume -= 0.2 * (1 - 0.1 * std::abs((n + 1) % 3 - n % 3)) * 0.9;
    return volume;
}

TriMesh hollow_box() {
    TriMesh hollow = box_mesh({0, 0, 0}, {10, 10, 10});
    append(hollow, box_mesh({1, 1, 1}, {9, 9, 9}, true));
    return hollow;
}

// Six corners; inward.
TriMesh octahedron(const Vec3& middle, double reach, double up) {
    TriMesh mesh;
    mesh.position = {middle + Vec3(reach, 0, 0),  middle + Vec3(0, reach, 0),
                     middle + Vec3(-reach, 0, 0), middle + Vec3(0, -reach, 0),
                     middle + Vec3(0, 0, up),     middle + Vec3(0, 0, -reach)};
    for (int k = 0; k < 4; ++k) {
        mesh.triangle.push_back({4, (k + 1) % 4, k});
        mesh.triangle.push_back({5, k, (k + 1) % 4});
    }
    return mesh;
}

}  // namespace

TEST_CASE("a chain of crossing bodies is united in whatever order its links stand") {
    for (const std::vector<int>& order :
         {std::vector{0, 1, 2}, std::vector{1, 0, 2}, std::vector{2, 0, 1}}) {
        const Repair repair = repair_mesh(chain(order));
        CHECK(told(repair, "united 3 crossing bodies"));
        CHECK(signed_volume(repair.mesh) == Approx(chain_volume(3)));
        CHECK(check_mesh(repair.mesh).components == 1);
    }
    std::vector<int> many;
    for (int n = 0; n < 60; ++n) many.push_back((7 * n) % 60);
    const Repair repair = repair_mesh(chain(many));
    CHECK(told(repair, "united 60 crossing bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(chain_volume(60)));
    CHECK(check_mesh(repair.mesh).components == 1);
}

TEST_CASE("a rib that runs from wall to wall of a cavity becomes one with the walls") {
    TriMesh ribbed = hollow_box();
    append(ribbed, box_mesh({4, 4, 0.5}, {6, 6, 9.5}));
    const Repair repair = repair_mesh(ribbed);
    CHECK(told(repair, "united 2 crossing bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(1000 - 512 + 4 * 8));
    CHECK(check_mesh(repair.mesh).bounds_a_volume());

    // Inside out, the whole of it.
    for (Corners& t : ribbed.triangle) std::swap(t[0], t[1]);
    const Repair turned = repair_mesh(ribbed);
    CHECK(told(turned, "inside out"));
    CHECK(signed_volume(turned.mesh) == Approx(1000 - 512 + 4 * 8));

    // A body that only stands on the cavity's floor.
    TriMesh standing = hollow_box();
    append(standing, box_mesh({4, 4, 1}, {6, 6, 5}));
    const Repair stands = repair_mesh(standing);
    CHECK(stands.account.empty());
    CHECK(signed_volume(stands.mesh) == Approx(488 + 16));

    // One that lies in the wall, flush with the cavity: there is nothing to add.
    TriMesh flush = hollow_box();
    append(flush, box_mesh({4, 4, 0.5}, {6, 6, 1}));
    CHECK(signed_volume(repair_mesh(flush).mesh) == Approx(488));
}

TEST_CASE("a cavity that touches the wall from within stays a cavity") {
    // It reaches the middle of the top face with one corner.
    TriMesh mesh = box_mesh({0, 0, 0}, {10, 10, 10});
    append(mesh, octahedron({6, 5, 5}, 3, 5));
    const double cavity = 2 * 9 * (3 + 5) / 3.0;
    const Repair repair = repair_mesh(mesh);
    CHECK(repair.account.empty());
    CHECK(signed_volume(repair.mesh) == Approx(1000 - cavity));

    for (Corners& t : mesh.triangle) std::swap(t[0], t[1]);
    const Repair turned = repair_mesh(mesh);
    CHECK(told(turned, "turned the whole surface"));
    CHECK(signed_volume(turned.mesh) == Approx(1000 - cavity));

    // An island in it counts, and what reaches through the wall is united.
    for (Corners& t : mesh.triangle) std::swap(t[0], t[1]);
    append(mesh, box_mesh({5.5, 4.5, 4.5}, {6.5, 5.5, 5.5}));
    CHECK(repair_mesh(mesh).account.empty());
    append(mesh, box_mesh({-1, 4, 4}, {1, 5, 5}));
    const Repair united = repair_mesh(mesh);
    CHECK(told(united, "united 2 crossing bodies"));
    CHECK(signed_volume(united.mesh) == Approx(1000 - cavity + 1 + 1));
}

TEST_CASE("an inside-out body half sunk into another is no cavity of it") {
    TriMesh mesh = box_mesh({0, 0, 0}, {2, 2, 2});
    append(mesh, box_mesh({0.5, 0.5, 1.5}, {1.5, 1.5, 2.5}, true));
    const Repair repair = repair_mesh(mesh);
    CHECK(told(repair, "turned 1 of 2 bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(8.5));
}

TEST_CASE("cavities that cross are one") {
    TriMesh mesh = box_mesh({0, 0, 0}, {10, 10, 10});
    append(mesh, box_mesh({1, 1, 1}, {6, 6, 6}, true));
    append(mesh, box_mesh({4, 4, 4}, {9, 9, 9}, true));
    const Repair repair = repair_mesh(mesh);
    CHECK(told(repair, "united 2 crossing cavities"));
    CHECK(signed_volume(repair.mesh) == Approx(1000 - 250 + 8));
    CHECK(check_mesh(repair.mesh).bounds_a_volume());

    // And stay so where the body crosses another.
    append(mesh, box_mesh({9.5, 4, 4}, {12, 6, 6}));
    CHECK(signed_volume(repair_mesh(mesh).mesh) == Approx(1000 - 250 + 8 + 8));
}

TEST_CASE("a mesh given twice, as two shells, is one body") {
    for (const bool inward : {false, true}) {
        TriMesh mesh = box_mesh({0, 0, 0}, {1, 2, 3});
        append(mesh, box_mesh({0, 0, 0}, {1, 2, 3}, inward));
        const Repair repair = repair_mesh(mesh);
        CHECK(told(repair, "united 2 crossing bodies: a volume of 6 m3"));
        CHECK(signed_volume(repair.mesh) == Approx(6));
        CHECK(check_mesh(repair.mesh).components == 1);
    }
}

namespace {

using Cell = std::array<int, 3>;
using Block = std::pair<Cell, Cell>;  // from one corner of a grid to another

// A box of unit squares.
TriMesh squared_box(const Block& block) {
    const auto& [low, high] = block;
    TriMesh mesh;
    const auto add = [&](int axis, bool upper) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int i = low[u]; i < high[u]; ++i)
            for (int j = low[v]; j < high[v]; ++j) {
                const int base = static_cast<int>(mesh.position.size());
                for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
                    Vec3 p;
                    p[axis] = upper ? high[axis] : low[axis];
                    p[u] = i + a;
                    p[v] = j + b;
                    mesh.position.push_back(p);
                }
                for (Corners t : {Corners{0, 1, 2}, Corners{0, 2, 3}}) {
                    if (!upper) std::swap(t[1], t[2]);
                    mesh.triangle.push_back({t[0] + base, t[1] + base, t[2] + base});
                }
            }
    };
    for (int axis = 0; axis < 3; ++axis)
        for (const bool upper : {false, true}) add(axis, upper);
    return mesh;
}

// Blocks as a file's parts, with one position for each place.
TriMesh welded_blocks(const std::vector<Block>& blocks, bool as_parts) {
    TriMesh mesh;
    for (const Block& block : blocks) {
        append(mesh, squared_box(block));
        if (!as_parts) continue;
        mesh.triangle_part.resize(mesh.triangle.size(), static_cast<int>(mesh.part_name.size()));
        mesh.part_name.push_back("block");
    }
    std::map<Cell, int> place;
    std::vector<Vec3> position;
    std::vector<int> number;
    for (const Vec3& p : mesh.position) {
        const Cell key = {static_cast<int>(p.x()), static_cast<int>(p.y()),
                          static_cast<int>(p.z())};
        const auto [at, is_new] = place.emplace(key, static_cast<int>(position.size()));
        if (is_new) position.push_back(p);
        number.push_back(at->second);
    }
    mesh.position = position;
    for (Corners& t : mesh.triangle)
        for (int& i : t) i = number[i];
    return mesh;
}

// Of all triangles, above their longest sides.
double smallest_height(const TriMesh& mesh) {
    double smallest = 1e9;
    for (const Corners& t : mesh.triangle) {
        const Vec3 a = mesh.position[t[1]] - mesh.position[t[0]];
        const Vec3 b = mesh.position[t[2]] - mesh.position[t[0]];
        const double longest = std::max({a.norm(), b.norm(), (b - a).norm()});
        smallest = std::min(smallest, a.cross(b).norm() / longest);
    }
    return smallest;
}

double union_volume(const std::vector<Block>& blocks) {
    std::set<Cell> filled;
    for (const auto& [low, high] : blocks)
        for (int x = low[0]; x < high[0]; ++x)
            for (int y = low[1]; y < high[1]; ++y)
                for (int z = low[2]; z < high[2]; ++z) filled.insert({x, y, z});
    return static_cast<double>(filled.size());
}

}  // namespace

TEST_CASE("bodies that cross and share edges of one grid are united to their true volume") {
    const Block bar = {{0, 1, 1}, {10, 3, 3}};
    const std::vector<std::vector<Block>> cases = {
        {bar, {{4, 2, 0}, {6, 5, 4}}},                             // no edge, no vertex of both
        {bar, {{4, 1, 0}, {6, 4, 4}}},                             // along two edges
        {bar, {{4, 3, 1}, {6, 5, 3}}, {{5, 2, 2}, {7, 4, 4}}},     // across a face that two share
        {bar, {{5, 1, 1}, {12, 3, 3}}},                            // one bar further into the other
        {bar, {{0, 1, 1}, {4, 5, 3}}},                             // flush on three sides
        {bar, {{4, 3, 3}, {6, 5, 5}}, {{4, 2, 2}, {6, 4, 4}}},     // two at one edge, one across it
        {bar, {{4, 0, 0}, {6, 3, 3}}, {{3, 1, 1}, {5, 5, 5}}},     // three through one edge
        {bar, {{10, 3, 3}, {12, 5, 5}}, {{9, 2, 2}, {11, 4, 4}}},  // two at one vertex
    };
    for (const std::vector<Block>& blocks : cases)
        for (const bool as_parts : {true, false}) {
            CAPTURE(union_volume(blocks), as_parts);
            TriMesh mesh = welded_blocks(blocks, as_parts);
            CHECK(!check_mesh(mesh).is_one_body());
            for (const bool inside_out : {false, true}) {
                if (inside_out)
                    for (Corners& t : mesh.triangle) std::swap(t[0], t[1]);
                const Repair repair = repair_mesh(mesh);
                CHECK(told(repair, "crossing bodies: a volume of"));
                const MeshReport report = check_mesh(repair.mesh);
                CHECK(report.bounds_a_volume());
                CHECK(report.volume == Approx(union_volume(blocks)));
                CHECK(report.degenerate_triangles == 0);
            }
        }
}

TEST_CASE("blocks of one grid are united however they lie to each other") {
    std::mt19937 random(5);
    for (int round = 0; round < 60; ++round) {
        std::vector<Block> blocks(2 + round % 3);
        const bool as_parts = round % 2 == 0;
        for (auto& [low, high] : blocks)
            for (int k = 0; k < 3; ++k) {
                low[k] = static_cast<int>(random() % 4);
                high[k] = low[k] + 1 + static_cast<int>(random() % 3);
            }
        CAPTURE(round);
        TriMesh mesh = welded_blocks(blocks, as_parts);
        if (round % 3 > 0) {  // what lies in one plane does so only nearly
            const Mat3 turn = Eigen::AngleAxisd(0.1 * round, Vec3(1, 2, 3).normalized()).matrix();
            for (Vec3& p : mesh.position) p = 0.01 * (turn * p);
        }
        const double scale = round % 3 > 0 ? 1e6 : 1;
        const TriMesh united = repair_mesh(mesh).mesh;
        const MeshReport report = check_mesh(united);
        CHECK(smallest_height(united) > 1e-4 * (round % 3 > 0 ? 0.01 : 1));
        CHECK(report.bounds_a_volume());
        CHECK(scale * report.volume == Approx(union_volume(blocks)));
    }
}

TEST_CASE("a union has no triangles without width where faces nearly lie on each other") {
    // A bar and a block on its face, off the bar's grid in one direction; both off by rounding.
    TriMesh bar = welded_blocks({{{0, 0, 0}, {20, 4, 4}}}, false);
    TriMesh block = welded_blocks({{{8, -1, -1}, {12, 4, 5}}}, false);
    for (Vec3& p : block.position) p.y() = p.y() < 1 ? p.y() : p.y() + 0.1;
    append(bar, block);
    std::mt19937 random(2);
    for (Vec3& p : bar.position)
        for (double& x : p) x = 0.01 * x + 1e-17 * (random() % 7);
    const TriMesh united = repair_mesh(bar).mesh;
    CHECK(signed_volume(united) == Approx(1e-6 * (20 * 16 + 4 * 5.1 * 6 - 4 * 16)));
    CHECK(check_mesh(united).bounds_a_volume());
    CHECK(smallest_height(united) > 1e-5);
}

TEST_CASE("bodies whose faces touch but for rounding are not lost, whatever their rounding") {
    // Two bars that end in one slanted face, whose triangles are the largest of both.
    const auto bar_from_to = [](double from, double to, double from_tilt, double to_tilt) {
        constexpr int kRings = 20;
        TriMesh bar;
        for (int n = 0; n <= kRings; ++n) {
            const double share = double(n) / kRings;
            for (const auto& [y, z] : {std::pair(-1.0, -1.0), {-1.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}})
                bar.position.push_back(
                    {(1 - share) * (from + from_tilt * y) + share * (to + to_tilt * y), y, z});
        }
        for (int n = 0; n < kRings; ++n)
            for (int k = 0; k < 4; ++k) {
                const int a = 4 * n + k, c = 4 * n + (k + 1) % 4;
                bar.triangle.push_back({a, c, c + 4});
                bar.triangle.push_back({a, c + 4, a + 4});
            }
        const int e = 4 * kRings;
        for (const Corners& c : {Corners{0, 2, 1}, {0, 3, 2}, {e, e + 1, e + 2}, {e, e + 2, e + 3}})
            bar.triangle.push_back(c);
        if (signed_volume(bar) < 0)
            for (Corners& c : bar.triangle) std::swap(c[1], c[2]);
        return bar;
    };
    const double tilt = std::tan(35 * std::numbers::pi / 180);
    for (const double rounding : {1e-15, 1e-13, 1e-11, 1e-10})
        for (unsigned seed = 0; seed < 12; ++seed) {
            TriMesh both = bar_from_to(-10, 2, 0, tilt);
            TriMesh other = bar_from_to(2, 10, tilt, 0);
            std::mt19937 random(seed);
            for (int p = 0; p < 4; ++p)
                for (double& x : other.position[p])
                    x += rounding * (2.0 * random() / double(random.max()) - 1);
            append(both, other);
            const TriMesh apart = box_mesh({-3, 5, -1}, {3, 7, 1});
            append(both, apart);
            const TriMesh settled = repair_mesh(both).mesh;
            CAPTURE(rounding, seed);
            CHECK(signed_volume(settled) == Approx(80 + 24).epsilon(1e-6));
            CHECK(check_mesh(settled).bounds_a_volume());
        }
}

TEST_CASE("what only touches, itself or another, stays as it is") {
    const Block one = {{0, 0, 0}, {2, 2, 2}};
    for (const Block& other : {Block{{2, 0, 0}, {4, 2, 2}},   // along a face
                               Block{{2, 1, 0}, {4, 3, 2}},   // along a part of one
                               Block{{2, 2, 0}, {4, 4, 2}},   // along an edge
                               Block{{2, 2, 2}, {4, 4, 4}}})  // at a vertex
        for (const bool as_parts : {true, false}) {
            const TriMesh mesh = welded_blocks({one, other}, as_parts);
            const Repair repair = repair_mesh(mesh);
            CHECK(repair.account.empty());
            CHECK(repair.mesh.triangle == mesh.triangle);
            CHECK(signed_volume(repair.mesh) == Approx(16));
        }

    // Two blocks and the bridge that makes them one body, which touches itself along an edge.
    const TriMesh bridged = repair_mesh(welded_blocks({one,
                                                       {{2, 2, 0}, {4, 4, 2}},
                                                       {{0, 0, -2}, {4, 4, 0}},
                                                       {{1, 1, -1}, {2, 2, 1}},
                                                       {{2, 2, -1}, {3, 3, 1}}},
                                                      true))
                                .mesh;
    CHECK(check_mesh(bridged).crowded_edges > 0);
    CHECK(signed_volume(bridged) == Approx(16 + 32));
    const Repair again = repair_mesh(bridged);
    CHECK(again.account.empty());
    CHECK(again.mesh.triangle == bridged.triangle);
    // Another that crosses it elsewhere is united with it.
    TriMesh crossed = bridged;
    append(crossed, box_mesh({0.5, 0.5, 1}, {1.5, 1.5, 3}));
    CHECK(signed_volume(repair_mesh(crossed).mesh) == Approx(48 + 1));
}

TEST_CASE("a body inside another of the same sense does not count twice") {
    TriMesh mesh = box_mesh({0, 0, 0}, {3, 3, 3});
    append(mesh, box_mesh({1, 1, 1}, {2, 2, 2}));
    const Repair repair = repair_mesh(mesh);
    CHECK(told(repair, "counted twice"));
    CHECK(signed_volume(repair.mesh) == Approx(27));
}

TEST_CASE("two bodies apart stay as they are; one inside out is turned") {
    TriMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    append(mesh, box_mesh({2, 0, 0}, {4, 1, 1}));
    CHECK(repair_mesh(mesh).account.empty());
    append(mesh, box_mesh({5, 0, 0}, {6, 1, 1}, true));
    const Repair repair = repair_mesh(mesh);
    CHECK(told(repair, "turned 1 of 3 bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(4));
}

TEST_CASE("crossing bodies are united to their true volume and keep their looks") {
    // Two crossing bars: neither has a vertex inside the other.
    TriMesh bars = box_mesh({-3, -0.5, -0.5}, {3, 0.5, 0.5});
    append(bars, box_mesh({-0.4, -3, -0.4}, {0.4, 3, 0.4}));
    bars.material.resize(2);
    bars.triangle_material.assign(12, 0);
    bars.triangle_material.resize(24, 1);
    for (const Vec3& p : bars.position) bars.uv.emplace_back(p.x(), p.y() + p.z());
    bars.triangle_uv = bars.triangle;
    const Repair repair = repair_mesh(bars);
    CHECK(told(repair, "united 2 crossing bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(6 + 0.64 * 6 - 0.64));
    CHECK(check_mesh(repair.mesh).manifold);
    REQUIRE(repair.mesh.triangle_uv.size() == repair.mesh.triangle.size());
    REQUIRE(repair.mesh.triangle_material.size() == repair.mesh.triangle.size());
    for (std::size_t t = 0; t < repair.mesh.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k) {  // a linear map stays linear through the cut
            const Vec3& p = repair.mesh.position[repair.mesh.triangle[t][k]];
            const Vec2& uv = repair.mesh.uv[repair.mesh.triangle_uv[t][k]];
            CHECK((uv - Vec2(p.x(), p.y() + p.z())).norm() < 1e-9);
        }
}

TEST_CASE("too many bodies that cross are left as they are, for that reason") {
    // Rods that all go through one place.
    TriMesh star;
    for (int n = 0; n < 102; ++n) {
        TriMesh rod = box_mesh({-1, -0.002, -0.002}, {1, 0.002, 0.002});
        const double turn = kPi * n / 102, tilt = 0.3 * std::sin(7.0 * n);
        for (Vec3& p : rod.position)
            p = Eigen::AngleAxisd(turn, Vec3::UnitZ()) * Eigen::AngleAxisd(tilt, Vec3::UnitY()) * p;
        append(star, rod);
    }
    const TriMesh before = star;
    std::vector<std::string> account;
    const auto reason = settle_bodies(star, kCreaseAngle, account);
    REQUIRE(reason);
    CHECK(*reason == "more than 5000 pairs of its parts cross or touch each other");
    CHECK(star.triangle == before.triangle);
    CHECK(account.empty());
}

TEST_CASE("bodies that share a face or a corner are left as they are") {
    // Welded: the inner wall is there twice, once each way.
    TriMesh pair = box_mesh({0, 0, 0}, {1, 1, 1});
    TriMesh next = box_mesh({1, 0, 0}, {2, 1, 1});
    const int match[8] = {1, -1, 3, -1, 5, -1, 7, -1};
    std::vector<int> place(8);
    for (int i = 0; i < 8; ++i) {
        place[i] = match[i] >= 0 ? match[i] : static_cast<int>(pair.position.size());
        if (match[i] < 0) pair.position.push_back(next.position[i]);
    }
    for (const Corners& t : next.triangle)
        pair.triangle.push_back({place[t[0]], place[t[1]], place[t[2]]});
    const Repair repair = repair_mesh(pair);
    CHECK(repair.account.empty());
    CHECK(signed_volume(repair.mesh) == Approx(2));
}
