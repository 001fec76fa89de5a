// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geometry/implicit.h"
#include "geometry/remesh.h"
#include "geometry/surface_nets.h"
#include "tests/catch.h"

using namespace swage;

namespace {

double ring_distance(const Vec3& p) {
    return std::hypot(std::hypot(p.x(), p.z()) - 0.6, p.y()) - 0.2;
}

TriMesh ring(double edge, double sample) {
    FieldMeshSettings settings;
    settings.box = {{-0.9, -0.3, -0.9}, {0.9, 0.3, 0.9}};
    settings.sample_spacing = sample;
    settings.edge_length = edge;
    return mesh_of_field(ring_distance, settings);
}

}  // namespace

TEST_CASE("a remeshed surface keeps its topology and place and has edges of the wanted length") {
    for (const double edge : {0.04, 0.08}) {
        const TriMesh mesh = ring(edge, 0.05);
        CHECK(mesh.position.size() * 2 == mesh.triangle.size());  // genus 1
        CHECK(signed_volume(mesh) == Approx(2 * kPi * kPi * 0.6 * 0.04).epsilon(edge));
        for (const Vec3& p : mesh.position) REQUIRE(std::abs(ring_distance(p)) < 1e-3 * edge);
        double mean = 0;
        for (const Corners& t : mesh.triangle)
            for (int k = 0; k < 3; ++k) {
                const double length = (mesh.position[t[k]] - mesh.position[t[(k + 1) % 3]]).norm();
                REQUIRE(length < 1.7 * edge);
                REQUIRE(length > 0.5 * edge);
                mean += length / (3.0 * static_cast<double>(mesh.triangle.size()));
            }
        CHECK(mean == Approx(edge).epsilon(0.1));
    }
}

TEST_CASE("kept triangles come through a remesh untouched") {
    // A block of voxels, its side x < 0 kept: flat faces need no projection.
    ScalarGrid grid;
    grid.count = Vec3i::Constant(12);
    for (int i = 0; i < grid.count.prod(); ++i) grid.value.push_back(-1);
    const TriMesh block = surface_nets(grid);
    RemeshSettings settings;
    settings.edge_length = [](const Vec3&) { return 2.0; };
    settings.project = [](const Vec3& p) { return p; };
    const auto centroid = [](const TriMesh& m, const Corners& t) -> Vec3 {
        return (m.position[t[0]] + m.position[t[1]] + m.position[t[2]]) / 3;
    };
    const auto on_top = [&](const TriMesh& m, const Corners& t) {
        return centroid(m, t).y() > 11.4 && centroid(m, t).x() > 1 && centroid(m, t).x() < 10 &&
               centroid(m, t).z() > 1 && centroid(m, t).z() < 10;
    };
    std::size_t kept = 0;
    for (const Corners& t : block.triangle) {
        settings.keep.push_back(!on_top(block, t));
        kept += settings.keep.back();
    }
    const TriMesh result = remesh(block, settings);
    std::size_t left = 0;
    for (const Corners& t : result.triangle) left += !on_top(result, t);
    CHECK(left == kept);
    CHECK(result.triangle.size() < block.triangle.size());
    CHECK(signed_volume(result) == Approx(signed_volume(block)).epsilon(1e-12));
}

TEST_CASE("an open surface is not remeshed") {
    TriMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangle = {{0, 1, 2}};
    RemeshSettings settings;
    settings.edge_length = [](const Vec3&) { return 1.0; };
    settings.project = [](const Vec3& p) { return p; };
    CHECK_THROWS_AS(remesh(mesh, settings), Error);
}
