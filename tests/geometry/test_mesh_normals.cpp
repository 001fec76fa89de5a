// SPDX-License-Identifier: GPL-3.0-or-later
// Normals that a file gives: as it says, where they make sense.
#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "geometry/mesh_write.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

namespace swage::test {

namespace {

constexpr double kTenthDegree = 0.1 * kPi / 180;

double angle_of(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

using CornerNormal = std::function<Vec3(const Vec3& at, const Vec3& face)>;

// With a normal a corner, of unit length or not.
std::string obj_of(const TriMesh& mesh, const CornerNormal& normal) {
    std::string text, faces;
    int count = 0;
    for (const Vec3& p : mesh.position) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    for (const Corners& t : mesh.triangle) {
        const Vec3 face = area_vector(mesh.position, t).normalized();
        faces += "f";
        for (const int i : t) {
            const Vec3 n = normal(mesh.position[i], face);
            text += fmt::format("vn {} {} {}\n", n.x(), n.y(), n.z());
            faces += fmt::format(" {}//{}", i + 1, ++count);
        }
        faces += "\n";
    }
    return text + faces;
}

// The largest angle between the normals that corners shade by and those wanted there.
double worst(const TriMesh& mesh, const std::vector<Vec3>& position, const CornerNormal& wanted) {
    const std::vector<Vec3> normal = smooth_normals(mesh, position);
    double most = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k)
            most = std::max(most, angle_of(normal[mesh.triangle_smooth[t][k]],
                                           wanted(mesh.position[mesh.triangle[t][k]],
                                                  area_vector(mesh.position, mesh.triangle[t]))));
    return most;
}

// An egg's: well off from what the faces of a ball tell.
Vec3 of_egg(const Vec3& at, const Vec3&) {
    return Vec3(at.x(), at.y(), 2 * at.z() + 0.05).normalized();
}
Vec3 of_ball(const Vec3& at, const Vec3&) { return at.normalized(); }

TriMesh read_obj_of(const Folder& folder, const TriMesh& mesh, const CornerNormal& normal) {
    return read_quietly(folder.write("mesh.obj", obj_of(mesh, normal)));
}

}  // namespace

TEST_CASE("edges are sharp beyond the crease angle where a file says nothing of smoothing") {
    const Folder folder;
    // A roof: its two slopes meet at 60 degrees.
    const std::string roof =
        "v 0 0 0\nv 2 0 0\nv 2 1 0.57735026918962576\nv 0 1 0.57735026918962576\nv 2 2 0\n"
        "v 0 2 0\n";
    const std::string faces = "f 1 2 3 4\nf 4 3 5 6\n";
    const auto groups = [&](const std::string& text, double degrees) {
        const auto file = folder.write("roof.obj", text);
        return read_mesh(file, {}, nullptr, degrees * kPi / 180).smooth_group_count;
    };
    CHECK(read_quietly(folder.write("roof.obj", roof + faces)).smooth_group_count == 8);
    CHECK(groups(roof + faces, 59) == 8);
    CHECK(groups(roof + faces, 61) == 6);
    CHECK(groups(roof + "s 1\n" + faces, 0) == 6);  // what it says counts
}

TEST_CASE("a corner's normal does not go by how its faces are divided") {
    TriMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
    smooth_by_crease_angle(box, kPi);
    const std::vector<Vec3> normal = smooth_normals(box, box.position);
    REQUIRE(normal.size() == 8);
    for (std::size_t t = 0; t < box.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3 out = 2 * box.position[box.triangle[t][k]] - Vec3::Ones();
            CHECK((normal[box.triangle_smooth[t][k]] - out.normalized()).norm() < 1e-12);
        }
}

TEST_CASE("a file's own normals are those that corners shade by, and that are written") {
    const Folder folder;
    const TriMesh ball = ball_mesh(8, 0.3);
    const TriMesh mesh = read_obj_of(folder, ball, of_egg);
    CHECK(worst(mesh, mesh.position, of_egg) < kTenthDegree);
    write_obj(folder / "written.obj", mesh);
    const TriMesh written = read_quietly(folder / "written.obj");
    CHECK(worst(written, written.position, of_egg) < kTenthDegree);
    CHECK(written.smooth_group_count == mesh.smooth_group_count);

    // They turn with the faces.
    const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    std::vector<Vec3> turned = mesh.position;
    for (Vec3& p : turned) p = turn * p;
    const auto turned_egg = [&](const Vec3& at, const Vec3& face) -> Vec3 {
        return turn * of_egg(at, face);
    };
    CHECK(worst(mesh, turned, turned_egg) < kTenthDegree);
}

TEST_CASE("normals that say what the faces tell are not kept apart from them") {
    const Folder folder;
    TriMesh ball = ball_mesh(8, 0.3);
    smooth_by_crease_angle(ball, 3);
    write_obj(folder / "made.obj", ball);
    const TriMesh read = read_quietly(folder / "made.obj");
    CHECK(read.smooth_normal.empty());
    CHECK(read.smooth_group_count == ball.smooth_group_count);

    const auto flat = [](const Vec3&, const Vec3& face) { return face; };
    CHECK(read_obj_of(folder, ball, flat).smooth_normal.empty());
}

TEST_CASE("normals of a file that differ by rounding alone are one") {
    const Folder folder;
    const TriMesh ball = ball_mesh(8, 0.3);
    int n = 0;
    const TriMesh mesh = read_obj_of(folder, ball, [&](const Vec3& at, const Vec3& face) {
        ++n;
        return Vec3(of_egg(at, face) + 4e-5 * Vec3(n % 2, n % 3, n % 5 - 2));
    });
    CHECK(mesh.smooth_group_count == static_cast<int>(ball.position.size()));
    CHECK(worst(mesh, mesh.position, of_egg) < kTenthDegree);
}

TEST_CASE("normals of a file that are no directions out of its faces are not taken") {
    const Folder folder;
    const TriMesh ball = ball_mesh(8, 0.3);
    const double coarse = 0.1;  // of what the faces of this ball tell
    const auto inward = [](const Vec3& at, const Vec3&) -> Vec3 { return -at.normalized(); };
    const auto upward = [](const Vec3&, const Vec3&) -> Vec3 { return Vec3::UnitZ(); };
    for (const CornerNormal& junk : {CornerNormal(inward), CornerNormal(upward)}) {
        const TriMesh mesh = read_obj_of(folder, ball, junk);
        CHECK(mesh.smooth_normal.empty());
        CHECK(worst(mesh, mesh.position, of_ball) < coarse);
    }
    // Where a few are junk the others stay, and theirs are made of the faces.
    int n = 0;
    const TriMesh mesh = read_obj_of(folder, ball, [&](const Vec3& at, const Vec3& face) {
        return n++ < 30 ? Vec3(Vec3::Zero()) : of_egg(at, face);
    });
    const std::vector<Vec3> normal = smooth_normals(mesh, mesh.position);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3& at = mesh.position[mesh.triangle[t][k]];
            const Vec3& own = normal[mesh.triangle_smooth[t][k]];
            INFO(t);
            if (t < 10)
                CHECK(angle_of(own, at) < 0.5);
            else
                CHECK(angle_of(own, of_egg(at, at)) < kTenthDegree);
        }
    const TriMesh stray = read_obj_of(folder, ball, [&](const Vec3& at, const Vec3& face) -> Vec3 {
        return at.x() > 0.28 ? Vec3(-at) : of_egg(at, face);
    });
    CHECK(worst(stray, stray.position, [](const Vec3& at, const Vec3& face) {
              return at.x() > 0.28 ? of_ball(at, face) : of_egg(at, face);
          }) < coarse);
}

TEST_CASE("a file's own normals outlast a repair, also of what it turns over") {
    const Folder folder;
    TriMesh ball = ball_mesh(8, 0.3);
    for (const bool inside_out : {false, true}) {
        TriMesh given = ball;
        if (inside_out) {
            for (Corners& t : given.triangle) std::swap(t[1], t[2]);
        } else {
            given.triangle.erase(given.triangle.begin() + 40, given.triangle.begin() + 44);
        }
        const double sense = inside_out ? -1 : 1;
        const TriMesh read = read_obj_of(
            folder, given,
            [&](const Vec3& at, const Vec3& face) -> Vec3 { return sense * of_egg(at, face); });
        const Repair repair = repair_mesh(read);
        REQUIRE_FALSE(repair.account.empty());
        TriMesh kept = repair.mesh;
        kept.triangle.resize(given.triangle.size());  // without what fills a hole
        kept.triangle_smooth.resize(given.triangle.size());
        CHECK(worst(kept, kept.position, of_egg) < kTenthDegree);
    }
}

TEST_CASE("a file's own normals outlast a union of crossing bodies") {
    const Folder folder;
    TriMesh bars = box_mesh({-3, -0.5, -0.5}, {3, 0.5, 0.5});
    append(bars, box_mesh({-0.4, -3, -0.4}, {0.4, 3, 0.4}, true));  // inside out
    const auto aslant = [](const Vec3&, const Vec3& face) -> Vec3 {
        return (face.normalized() + 0.2 * face.normalized().cwiseAbs().cross(Vec3(1, 2, 3)))
            .normalized();
    };
    const TriMesh read = read_obj_of(folder, bars, [&](const Vec3& at, const Vec3& face) -> Vec3 {
        const bool turned = std::abs(at.y()) > 1;
        return turned ? Vec3(-aslant(at, -face)) : aslant(at, face);
    });
    REQUIRE_FALSE(read.smooth_normal.empty());
    const Repair repair = repair_mesh(read);
    REQUIRE(told(repair, "united 2 crossing bodies"));
    CHECK(worst(repair.mesh, repair.mesh.position, aslant) < kTenthDegree);
}

}  // namespace swage::test
