// SPDX-License-Identifier: GPL-3.0-or-later
// What the repair makes of bodies whose faces lie on each other, exactly or but for rounding.
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

TEST_CASE("turned boxes with faces in one plane but for rounding are united to their true volume") {
    std::mt19937 random(3);
    int crossing = 0, touching = 0;
    for (int round = 0; round < 150; ++round) {
        std::vector<Block> blocks(2);
        for (auto& [low, high] : blocks)
            for (int k = 0; k < 3; ++k) {
                low[k] = static_cast<int>(random() % 3);
                high[k] = low[k] + 1 + static_cast<int>(random() % 3);
            }
        const Mat3 turn =
            Eigen::AngleAxisd(0.02 + 0.0131 * (random() % 100), Vec3(1, 2, 3).normalized())
                .matrix();
        TriMesh mesh;
        double sum = 0;
        for (const auto& [low, high] : blocks) {
            append(mesh, box_mesh({double(low[0]), double(low[1]), double(low[2])},
                                  {double(high[0]), double(high[1]), double(high[2])}));
            sum += union_volume({{low, high}});
        }
        for (Vec3& p : mesh.position) p = turn * p;
        const double volume = union_volume(blocks);
        const Repair repair = repair_mesh(mesh);
        const MeshReport report = check_mesh(repair.mesh);
        CAPTURE(round, volume, sum);
        CHECK(report.volume == Approx(volume).epsilon(1e-6));
        CHECK(report.bounds_a_volume());
        CHECK(smallest_height(repair.mesh) > 1e-4);
        touching += volume == sum && report.components == 2;
        crossing += volume < sum && report.components == 1;
    }
    CHECK(touching > 30);
    CHECK(crossing > 30);
    CHECK(touching + crossing > 140);
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
