// SPDX-License-Identifier: GPL-3.0-or-later
// Cut faces of bodies with something inside: what each shows, and how much of it.
#include "geometry/box_mesh.h"
#include "tests/skin/cut_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kRadius = 0.07;
constexpr int kSides = 96;

SurfaceMaterial look_of(const std::string& name) {
    SurfaceMaterial look;
    look.name = cut_name(name);
    look.takes_colors = false;
    look.color = {0.1, 0.2, 0.3};
    return look;
}

// A prism that is a cylinder but for 7e-4 of its area, along x about (y, z).
TriMesh cylinder(double from, double to, double y = 0, double z = 0, double radius = kRadius) {
    constexpr int kAlong = 20;
    TriMesh mesh;
    for (int i = 0; i <= kAlong; ++i) {
        for (int j = 0; j < kSides; ++j) {
            const double turn = 2 * kPi * j / kSides;
            mesh.position.push_back({from + (to - from) * i / kAlong, y + radius * std::cos(turn),
                                     z + radius * std::sin(turn)});
        }
    }
    for (int i = 0; i < kAlong; ++i) {
        for (int j = 0; j < kSides; ++j) {
            const int a = kSides * i + j, b = kSides * i + (j + 1) % kSides;
            mesh.triangle.push_back({a, b, b + kSides});
            mesh.triangle.push_back({a, b + kSides, a + kSides});
        }
    }
    for (const int end : {0, kAlong}) {
        const int middle = static_cast<int>(mesh.position.size()), first = kSides * end;
        mesh.position.push_back({end == 0 ? from : to, y, z});
        for (int j = 0; j < kSides; ++j) {
            const int a = first + j, b = first + (j + 1) % kSides;
            mesh.triangle.push_back(end == 0 ? Corners{middle, b, a} : Corners{middle, a, b});
        }
    }
    if (signed_volume(mesh) < 0) mesh = turned_inside_out(mesh);
    return mesh;
}
const double kDisc = 0.5 * kSides * kRadius * kRadius * std::sin(2 * kPi / kSides);

// Of a cut face on each side of a plane: below, above.
std::map<std::string, std::array<double, 2>> cut_areas(const Fixture& f, const Vec3& normal) {
    std::map<std::string, std::array<double, 2>> area;
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        const SurfaceMaterial& look = f.mesh.material[f.mesh.triangle_material[t]];
        if (!is_cut_look(look)) continue;
        const double own = 0.5 * area_vector(f.position, f.mesh.triangle[t]).dot(normal);
        // What lies below looks up.
        area[look.name][own > 0 ? 0 : 1] += std::abs(own);
    }
    return area;
}

void check_both(const std::array<double, 2>& area, double should, double within = 1e-3) {
    CHECK(area[0] == Approx(should).epsilon(within));
    CHECK(area[1] == Approx(area[0]).epsilon(1e-9));
}

Insides one(const TriMesh& mesh) {
    Insides insides;
    insides.add(mesh, look_of("core"));
    return insides;
}

}  // namespace

TEST_CASE("a cut face shows a core by as much as the plane has of it, on both sides") {
    REQUIRE(kDisc == Approx(kPi * kRadius * kRadius).epsilon(1e-3));
    const auto [point, normal] = GENERATE(table<Vec3, Vec3>({
        {Vec3(.0137, 0, 0), Vec3(1, 0, 0)},
        {Vec3(0, 0, 0), Vec3(1, 0, 0)},  // through vertices of both
        {Vec3(.01, 0, 0), Vec3(1, 0.4, 0)},
        {Vec3(.02, .01, -.03), Vec3(1, .4, -.7)},
    }));
    const Vec3 n = normal.normalized();
    Fixture f(bar()), plain(bar());
    const double whole = signed_volume(f.mesh);
    const CutResult result = f.cut(sweep_of(point, n, 3), one(cylinder(-0.7, 0.7)));
    plain.cut(sweep_of(point, n, 3));
    CHECK(result.open_parts == 0);
    check_sound(f.mesh, f.position);
    double sum = 0;
    for (const TriMesh& part : parts_of(f.mesh)) {
        CHECK(test::is_closed(part));
        sum += signed_volume(part);
    }
    CHECK(sum == Approx(whole).epsilon(1e-9));
    auto area = cut_areas(f, n);
    REQUIRE(area.size() == 2);
    check_both(area.at("cut_core"), kDisc / std::abs(n.x()));
    // As large as without, all in all.
    check_both({area["cut"][0] + area["cut_core"][0], area["cut"][1] + area["cut_core"][1]},
               cut_areas(plain, n).at("cut")[0], 1e-9);
    CHECK(cap_triangles(f.mesh) < 4 * cap_triangles(plain.mesh));
}

TEST_CASE("the edge of what a cut face shows runs along what lies there") {
    Fixture f(bar());
    f.cut(sweep_of({.0137, 0, 0}, Vec3::UnitX(), 3), one(cylinder(-0.7, 0.7)));
    double farthest = 0, nearest = 1;
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        const std::string& name = f.mesh.material[f.mesh.triangle_material[t]].name;
        if (name != "cut" && name != "cut_core") continue;
        for (const int v : f.mesh.triangle[t]) {
            const double r = f.position[v].tail<2>().norm();
            if (name == "cut") nearest = std::min(nearest, r);
            if (name == "cut_core") farthest = std::max(farthest, r);
        }
    }
    CHECK(nearest > 0.995 * kRadius);
    CHECK(farthest < 1.001 * kRadius);
}

TEST_CASE("a layer goes on to the surface of the body") {
    // Straight above its side, and aslant.
    const auto [normal, height] =
        GENERATE(table<Vec3, double>({{Vec3(1, 0, 0), 0.0123}, {Vec3(1, 0.3, 0.5), -0.031}}));
    const Vec3 n = normal.normalized();
    Fixture f(bar());
    const TriMesh layer = swage::box_mesh({-0.6, -0.2, -0.2}, {0.6, height, 0.2});
    f.cut(sweep_of({.0137, 0, 0}, n, 3), one(layer));
    check_sound(f.mesh, f.position);
    const auto area = cut_areas(f, n);
    // Vertices next to the plane count as on it.
    const double within = n == Vec3::UnitX() ? 1e-9 : 5e-4;
    check_both(area.at("cut_core"), 0.3 * (0.15 + height) / n.x(), within);
    check_both(area.at("cut"), 0.3 * (0.15 - height) / n.x(), within);
    // What was made at the surface has its texture and its own smoothing.
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int uv = f.mesh.triangle_uv[t][k];
            REQUIRE((uv < 0) == is_cut_look(f.mesh.material[f.mesh.triangle_material[t]]));
            if (uv < 0) continue;
            const Vec3& p = f.mesh.position[f.mesh.triangle[t][k]];
            REQUIRE((f.mesh.uv[uv] - Vec2(p.x() + 2 * p.y(), p.z() - p.x())).norm() < 1e-12);
        }
    }
    std::map<int, int> vertex_of;
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int group = f.mesh.triangle_smooth[t][k], v = f.mesh.triangle[t][k];
            REQUIRE(vertex_of.emplace(group, v).first->second == v);
        }
    }
    const std::vector<Vec3> normals = smooth_normals(f.mesh, f.position);
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        const Vec3 own = area_vector(f.position, f.mesh.triangle[t]).normalized();
        for (const int group : f.mesh.triangle_smooth[t]) CHECK(normals[group].dot(own) > 0.99);
    }
}

TEST_CASE(
    "insets that touch share an edge of the cut face, and of those that overlap the last "
    "counts") {
    Insides insides;
    insides.add(swage::box_mesh({-0.6, -0.08, -0.06}, {0.6, 0.02, 0.06}), look_of("a"));
    insides.add(swage::box_mesh({-0.6, 0.02, -0.09}, {0.6, 0.07, 0.06}), look_of("b"));
    insides.add(swage::box_mesh({-0.6, -0.02, -0.01}, {0.6, 0.04, 0.2}), look_of("c"));
    Fixture f(bar());
    f.cut(sweep_of({.0137, 0, 0}, Vec3::UnitX(), 3), insides);
    check_sound(f.mesh, f.position);
    const auto area = cut_areas(f, Vec3::UnitX());
    check_both(area.at("cut_a"), 0.1 * 0.12 - 0.04 * 0.07, 1e-9);
    check_both(area.at("cut_b"), 0.05 * 0.15 - 0.02 * 0.07, 1e-9);
    check_both(area.at("cut_c"), 0.06 * 0.16, 1e-9);
}

TEST_CASE("a cut through nothing but an inset has no other look than its") {
    TriMesh plain = bar();
    plain.material.clear();
    plain.triangle_material.clear();
    for (const TriMesh& mesh : {bar(), plain}) {
        Fixture f(mesh);
        const std::size_t looks = std::max<std::size_t>(1, f.mesh.material.size());
        f.cut(sweep_of({.0137, 0, 0}, Vec3::UnitX(), 3),
              one(swage::box_mesh({-0.6, -0.2, -0.2}, {0.6, 0.2, 0.2})));
        const auto area = cut_areas(f, Vec3::UnitX());
        REQUIRE(area.size() == 1);
        check_both(area.at("cut_core"), 0.3 * 0.3, 1e-9);
        REQUIRE(f.mesh.material.size() == looks + 1);
        CHECK(f.mesh.material.back().name == "cut_core");
    }
}

TEST_CASE("a blade that stops within the body shows what it has gone through") {
    Fixture f(bar());
    const Vec3 p(.0137, 0, 0);
    const auto at = [&](double y, double z) -> Vec3 { return p + Vec3(0, y, z); };
    // Half of the core, of the face and of its rim.
    f.cut({{at(0, -1), at(1, -1), at(1, 1)}, {at(0, -1), at(1, 1), at(0, 1)}},
          one(swage::box_mesh({-0.6, -0.05, -0.2}, {0.6, 0.05, 0.0})));
    CHECK(test::is_closed(f.mesh));
    const auto area = cut_areas(f, Vec3::UnitX());
    CHECK(area.at("cut_core")[0] == Approx(0.05 * 0.15).epsilon(0.1));
    CHECK(area.at("cut_core")[1] == Approx(area.at("cut_core")[0]).epsilon(1e-9));
}

TEST_CASE("blades that cross within a core each show it") {
    Fixture f(bar());
    Sweep both = sweep_of({.0137, 0, 0}, Vec3::UnitX(), 3);
    for (const auto& t : sweep_of({0, .0123, 0}, Vec3::UnitY(), 3)) both.push_back(t);
    const double whole = signed_volume(f.mesh);
    CHECK(f.cut(both, one(cylinder(-0.7, 0.7))).cuts == 2);
    check_sound(f.mesh, f.position);
    CHECK(parts_of(f.mesh).size() == 4);
    CHECK(signed_volume(f.mesh) == Approx(whole).epsilon(1e-9));
    check_both(cut_areas(f, Vec3::UnitX()).at("cut_core"), kDisc);
    const double chord = 2 * std::sqrt(kRadius * kRadius - .0123 * .0123);
    check_both(cut_areas(f, Vec3::UnitY()).at("cut_core"), chord * 1.0, 2e-3);
}

TEST_CASE("what no plane meets leaves a cut as it would be, to the bit") {
    Fixture f(bar()), plain(bar());
    f.cut(sweep_of({.0137, 0, 0}, Vec3::UnitX(), 3), one(cylinder(0.1, 0.4)));
    plain.cut(sweep_of({.0137, 0, 0}, Vec3::UnitX(), 3));
    CHECK(f.position == plain.position);
    CHECK(f.mesh.triangle == plain.mesh.triangle);
    CHECK(f.mesh.material.size() == plain.mesh.material.size());
}
