// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "geometry/edges.h"
#include "geometry/gradient_noise.h"
#include "geometry/surface_nets.h"
#include "tests/catch.h"

using namespace swage;

namespace {

ScalarGrid sampled(int count, double half, const std::function<double(const Vec3&)>& field) {
    ScalarGrid grid;
    grid.count = Vec3i::Constant(count);
    grid.spacing = 2 * half / (count - 1);
    grid.origin = Vec3::Constant(-half);
    for (int k = 0; k < count; ++k)
        for (int j = 0; j < count; ++j)
            for (int i = 0; i < count; ++i) grid.value.push_back(field(grid.point(i, j, k)));
    return grid;
}

// Every edge has two triangles in opposite directions, every position one closed fan.
bool is_manifold(const TriMesh& mesh) {
    bool good = true;
    std::vector<int> edges_at(mesh.position.size(), 0), triangles_at(mesh.position.size(), 0);
    std::vector<std::array<int, 2>> next;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        good = good && uses.size() == 2 && uses[0].forward != uses[1].forward;
        ++edges_at[uses[0].low];
        ++edges_at[uses[0].high];
    });
    for (const Corners& t : mesh.triangle) {
        good = good && t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        for (int p : t) ++triangles_at[p];
    }
    // With every edge paired, fans are closed; walk one and see whether it takes in all.
    std::vector<std::vector<std::array<int, 2>>> link(mesh.position.size());
    for (const Corners& t : mesh.triangle)
        for (int k = 0; k < 3; ++k) link[t[k]].push_back({t[(k + 1) % 3], t[(k + 2) % 3]});
    for (std::size_t v = 0; v < link.size() && good; ++v) {
        good = !link[v].empty() && edges_at[v] == triangles_at[v];
        if (!good) break;
        int at = link[v][0][1];
        std::size_t steps = 1;
        while (at != link[v][0][0] && steps <= link[v].size()) {
            for (const auto& side : link[v])
                if (side[0] == at) {
                    at = side[1];
                    break;
                }
            ++steps;
        }
        good = steps == link[v].size();
    }
    return good;
}

int euler_characteristic(const TriMesh& mesh) {
    return static_cast<int>(mesh.position.size()) - static_cast<int>(mesh.triangle.size()) / 2;
}

}  // namespace

TEST_CASE(
    "surface nets of a ball come close to its volume and area with the square of the spacing") {
    std::array<double, 3> volume_error, area_error;
    int i = 0;
    for (const int count : {17, 33, 65}) {
        const TriMesh mesh =
            surface_nets(sampled(count, 1.0, [](const Vec3& p) { return p.norm() - 0.7; }));
        REQUIRE(is_manifold(mesh));
        CHECK(euler_characteristic(mesh) == 2);
        volume_error[i] = std::abs(signed_volume(mesh) / (4 * kPi / 3 * 0.343) - 1);
        area_error[i] = std::abs(surface_area(mesh) / (4 * kPi * 0.49) - 1);
        CHECK(signed_volume(mesh) > 0);
        ++i;
    }
    CHECK(volume_error[2] < 3e-3);
    CHECK(area_error[2] < 2e-3);
    for (const int k : {0, 1}) {
        CHECK(std::log2(volume_error[k] / volume_error[k + 1]) > 1.7);
        CHECK(std::log2(area_error[k] / area_error[k + 1]) > 1.7);
    }
}

TEST_CASE("surface nets keep the hole of a torus") {
    const TriMesh mesh = surface_nets(sampled(40, 1.0, [](const Vec3& p) {
        return std::hypot(std::hypot(p.x(), p.z()) - 0.6, p.y()) - 0.2;
    }));
    CHECK(is_manifold(mesh));
    CHECK(euler_characteristic(mesh) == 0);
    CHECK(surface_components(mesh).count == 1);
    CHECK(signed_volume(mesh) == Approx(2 * kPi * kPi * 0.6 * 0.04).epsilon(0.03));
}

TEST_CASE("surface nets stay manifold where two bodies touch along an edge or at a corner") {
    const auto blocks = [](const Vec3i& second) {
        return surface_nets(sampled(9, 4.0, [&](const Vec3& p) {
            const Vec3i at = p.array().round().cast<int>();
            const bool in_first = (at.array() >= -2).all() && (at.array() < 0).all();
            const Vec3i moved = at - second;
            const bool in_second = (moved.array() >= -2).all() && (moved.array() < 0).all();
            return in_first || in_second ? -1.0 : 1.0;
        }));
    };
    for (const Vec3i& second : {Vec3i(2, 2, 0), Vec3i(2, 2, 2), Vec3i(2, -2, 0), Vec3i(-2, 2, 2)}) {
        const TriMesh mesh = blocks(second);
        CHECK(is_manifold(mesh));
        CHECK(surface_components(mesh).count == 2);
    }
    const TriMesh joined = blocks({2, 0, 0});
    CHECK(is_manifold(joined));
    CHECK(surface_components(joined).count == 1);
}

TEST_CASE("surface nets of any yes and no pattern are closed and manifold") {
    for (int seed = 1; seed <= 40; ++seed) {
        ScalarGrid grid;
        grid.count = {9, 8, 10};
        const unsigned share = 20 + 5 * (seed % 14);  // percent inside
        for (int i = 0; i < grid.count.prod(); ++i)
            grid.value.push_back(hash_of_cell(i, 0, 0, seed) % 100 < share ? -1.0 : 1.0);
        const TriMesh mesh = surface_nets(grid);
        INFO("seed " << seed);
        CHECK(is_manifold(mesh));
        CHECK(signed_volume(mesh) > 0);
    }
}

TEST_CASE("a body that reaches the rim of its grid is closed there") {
    const TriMesh mesh = surface_nets(sampled(12, 1.0, [](const Vec3&) { return -1.0; }));
    CHECK(is_manifold(mesh));
    CHECK(euler_characteristic(mesh) == 2);
    CHECK(surface_nets(sampled(5, 1.0, [](const Vec3&) { return 1.0; })).triangle.empty());
}

TEST_CASE("a grid whose sizes do not agree is refused") {
    ScalarGrid grid;
    grid.count = {2, 2, 2};
    grid.value.assign(7, 1.0);
    CHECK_THROWS_AS(surface_nets(grid), Error);
}
