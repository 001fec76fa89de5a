// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include "geometry/box_mesh.h"
#include "geometry/mesh_check.h"
#include "skin/divided_mesh.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

// A bar of twelve triangles whose every face has its own place in the texture, hard edges, a colour
// that changes along it, and two materials and parts.
TriMesh coarse_bar() {
    TriMesh mesh = box_mesh({0, 0, 0}, {2, 0.2, 0.3});
    for (const Vec3& p : mesh.position) {
        mesh.position_color.push_back(Eigen::Vector3f(float(p.x()) / 2, 0.25f, 1));
    }
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        Corners own;
        for (int c = 0; c < 3; ++c) {
            const Vec3& p = mesh.position[mesh.triangle[t][c]];
            own[c] = static_cast<int>(mesh.uv.size());
            mesh.uv.push_back({10.0 * double(t) + p.x() + 2 * p.y(), 3 * p.z() - p.y()});
        }
        mesh.triangle_uv.push_back(own);
        mesh.triangle_material.push_back(t < 4);
        mesh.triangle_part.push_back(t % 2);
    }
    mesh.material.resize(2);
    mesh.part_name = {"even", "odd"};
    smooth_by_crease_angle(mesh, 0.5);
    return mesh;
}

double longest_edge(const TriMesh& mesh) {
    double most = 0;
    for (const Corners& c : mesh.triangle) {
        for (int k = 0; k < 3; ++k) {
            most = std::max(most, (mesh.position[c[(k + 1) % 3]] - mesh.position[c[k]]).norm());
        }
    }
    return most;
}

// The least height of a triangle, over its longest edge.
double thinnest(const TriMesh& mesh) {
    double least = 1;
    for (const Corners& c : mesh.triangle) {
        const Vec3 &p = mesh.position[c[0]], &q = mesh.position[c[1]], &r = mesh.position[c[2]];
        const double high = std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()});
        least = std::min(least, (q - p).cross(r - p).norm() / (high * high));
    }
    return least;
}

}  // namespace

TEST_CASE("a divided mesh is the same surface, closed, of short edges") {
    const TriMesh coarse = coarse_bar();
    for (double longest : {1.5, 0.15, 0.04}) {
        const TriMesh fine = divide_edges(coarse, longest);
        CHECK(longest_edge(fine) <= longest);
        CHECK(signed_volume(fine) == Approx(2 * 0.2 * 0.3).epsilon(1e-12));
        CHECK(surface_area(fine) == Approx(surface_area(coarse)).epsilon(1e-12));
        const MeshReport report = check_mesh(fine);
        CHECK(report.bounds_a_volume());
        CHECK(report.components == 1);
        for (std::size_t v = 0; v < coarse.position.size(); ++v) {
            CHECK(fine.position[v] == coarse.position[v]);
        }
        // Not many more than are asked for: of equal edges of 0.43 of `longest` there were so many.
        CHECK(double(fine.triangle.size()) <
              24 + surface_area(coarse) / (0.08 * longest * longest));
        CHECK(thinnest(fine) > 0.5 * thinnest(coarse));
    }
}

TEST_CASE("what a mesh carries goes on over the parts of its triangles") {
    const TriMesh coarse = coarse_bar();
    const TriMesh fine = divide_edges(coarse, 0.1);
    REQUIRE(fine.triangle_uv.size() == fine.triangle.size());
    REQUIRE(fine.triangle_material.size() == fine.triangle.size());
    REQUIRE(fine.triangle_part.size() == fine.triangle.size());
    REQUIRE(fine.position_color.size() == fine.position.size());
    CHECK(fine.part_name == coarse.part_name);
    std::map<int, double> area;  // by the old triangle that the texture tells of
    const std::vector<Vec3> normal = smooth_normals(fine, fine.position);
    double off = 0;
    for (std::size_t t = 0; t < fine.triangle.size(); ++t) {
        const Corners& c = fine.triangle[t];
        const int from = static_cast<int>(fine.uv[fine.triangle_uv[t][0]].x() + 1) / 10;
        const Vec3 across = (fine.position[c[1]] - fine.position[c[0]])
                                .cross(fine.position[c[2]] - fine.position[c[0]]);
        area[from] += 0.5 * across.norm();
        CHECK(fine.triangle_material[t] == coarse.triangle_material[from]);
        CHECK(fine.triangle_part[t] == coarse.triangle_part[from]);
        for (int k = 0; k < 3; ++k) {
            const Vec3& p = fine.position[c[k]];
            const Vec2& uv = fine.uv[fine.triangle_uv[t][k]];
            off = std::max(off, std::abs(uv.x() - (10.0 * from + p.x() + 2 * p.y())));
            off = std::max(off, std::abs(uv.y() - (3 * p.z() - p.y())));
            off = std::max(off, double(std::abs(fine.position_color[c[k]].x() - float(p.x()) / 2)));
            // Hard edges stay hard, and faces flat.
            off = std::max(off, (normal[fine.triangle_smooth[t][k]] - across.normalized()).norm());
        }
    }
    CHECK(off < 1e-5);
    REQUIRE(area.size() == 12);
    for (std::size_t t = 0; t < 12; ++t) {
        const Corners& c = coarse.triangle[t];
        const Vec3& p = coarse.position[c[0]];
        const double own =
            0.5 * (coarse.position[c[1]] - p).cross(coarse.position[c[2]] - p).norm();
        CHECK(area[int(t)] == Approx(own));
    }
}

namespace {

// A prism of eight sides along z that shade as a cylinder, its ends flat, of 32 triangles.
TriMesh round_prism() {
    constexpr int kSides = 8;
    TriMesh mesh;
    for (int n = 0; n < kSides; ++n) {
        const double angle = 2 * kPi * n / kSides;
        for (double z : {0., 3.}) mesh.position.push_back({std::cos(angle), std::sin(angle), z});
    }
    mesh.position.insert(mesh.position.end(), {{0, 0, 0}, {0, 0, 3}});
    const int low = 2 * kSides, high = low + 1;
    for (int n = 0; n < kSides; ++n) {
        const int a = 2 * n, b = 2 * ((n + 1) % kSides);
        mesh.triangle.insert(mesh.triangle.end(), {{a, b, b + 1}, {a, b + 1, a + 1}});
        mesh.triangle.insert(mesh.triangle.end(), {{low, b, a}, {high, a + 1, b + 1}});
    }
    smooth_by_crease_angle(mesh, 0.9);
    return mesh;
}

// The largest error of a normal on the sides and on the ends of that prism, each at `now`, against
// what `map`, linear, makes of the straight line between the corners' normals.
double worst_shade(const TriMesh& mesh, const Mat3& map) {
    std::vector<Vec3> now;
    for (const Vec3& p : mesh.position) now.push_back(map * p);
    const std::vector<Vec3> normal = smooth_normals(mesh, now);
    const Mat3 turn = map.inverse().transpose();
    double worst = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const Vec3 face = area_vector(mesh.position, mesh.triangle[t]);
        const bool is_end = std::abs(face.z()) > 0.5 * face.norm();
        for (int k = 0; k < 3; ++k) {
            Vec3 should = mesh.position[mesh.triangle[t][k]];
            should = is_end ? Vec3(0, 0, face.z()) : Vec3(should.x(), should.y(), 0);
            const Vec3& is = normal[mesh.triangle_smooth[t][k]];
            worst = std::max(worst, (is - (turn * should).normalized()).norm());
        }
    }
    return worst;
}

}  // namespace

TEST_CASE("a divided mesh shades as the whole one, and its shade goes with what becomes of it") {
    const TriMesh coarse = round_prism();
    REQUIRE(worst_shade(coarse, Mat3::Identity()) < 1e-12);
    const Mat3 drawn = Vec3(0.7, 0.7, 1 / 0.49).asDiagonal();  // of the same volume
    const Mat3 pressed = Vec3(1.25, 0.8, 1).asDiagonal();
    const Mat3 turn = Quat(Eigen::AngleAxisd(2, Vec3(1, 2, 3).normalized())).toRotationMatrix();
    for (double longest : {1.5, 0.3, 0.1}) {
        const TriMesh fine = divide_edges(coarse, longest);
        REQUIRE(fine.triangle.size() > coarse.triangle.size());
        CHECK(worst_shade(fine, Mat3::Identity()) < 1e-9);
        CHECK(worst_shade(fine, turn) < 1e-9);
        CHECK(worst_shade(fine, turn * drawn) < 1e-9);
        CHECK(worst_shade(fine, turn * pressed) < 0.1);  // flat faces: 0.4
        CHECK(worst_shade(divide_edges(fine, longest / 2), Mat3::Identity()) < 1e-9);
    }
}

TEST_CASE("edges so far from the origin that they have no middle are left") {
    TriMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    for (Vec3& p : mesh.position) p += Vec3::Constant(1e15);
    const TriMesh divided = divide_edges(mesh, 1e-3);
    CHECK(longest_edge(divided) < 1);
    CHECK(divided.triangle.size() < 10'000);
}

TEST_CASE("a mesh of short edges is not touched, nor one of none") {
    const TriMesh ball = test::sphere_mesh(1, 3);
    const TriMesh same = divide_edges(ball, longest_edge(ball));
    CHECK(same.position == ball.position);
    CHECK(same.triangle == ball.triangle);
    CHECK(divide_edges({}, 1).triangle.empty());
}
