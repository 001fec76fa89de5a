// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <set>

#include "geometry/triangle_tree.h"
#include "skin/boundary.h"
#include "skin/divided_mesh.h"
#include "skin/settings.h"
#include "skin/thick_triangles.h"
#include "skin/warp.h"
#include "tests/skin/broken_fixture.h"

using namespace swage;

namespace {

using Fixture = test::BrokenFixture;

constexpr double kRough = SkinSettings{}.roughness;

std::array<double, 3> key(const Vec3& p) { return {p[0], p[1], p[2]}; }

// Volume of each of the parts that hang together.
std::vector<double> volumes(const TriMesh& mesh, const Components& parts) {
    std::vector<double> volume(parts.count, 0.0);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const auto& [a, b, c] = mesh.triangle[t];
        const Vec3 &p = mesh.position[a], &q = mesh.position[b], &r = mesh.position[c];
        volume[parts.triangle_component[t]] += p.dot(q.cross(r)) / 6;
    }
    return volume;
}

bool is_cut(const TriMesh& mesh, std::size_t t) {
    return mesh.material[mesh.triangle_material[t]].name == kCutMaterial;
}

// Of the triangles, those thinner than a thousandth of `a`.
double share_of_slivers(const TriMesh& mesh, double a) {
    const auto is_thin = [&](const Corners& c) {
        const Vec3 &p = mesh.position[c[0]], &q = mesh.position[c[1]], &r = mesh.position[c[2]];
        return thickness(p, q, r) < 1e-3 * a;
    };
    const auto thin = std::count_if(mesh.triangle.begin(), mesh.triangle.end(), is_thin);
    return static_cast<double>(thin) / static_cast<double>(mesh.triangle.size());
}

// How often a segment goes through a triangle, both without their ends and rims.
bool pierces(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& c) {
    const auto side = [](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
        return (q - p).cross(r - p).dot(s - p);
    };
    constexpr double kFlat = 1e-15;
    const double low = side(c[0], c[1], c[2], from), high = side(c[0], c[1], c[2], to);
    if (!(low * high < 0) || std::min(std::abs(low), std::abs(high)) < kFlat) return false;
    const double u = side(from, to, c[0], c[1]), v = side(from, to, c[1], c[2]),
                 w = side(from, to, c[2], c[0]);
    return (u > kFlat && v > kFlat && w > kFlat) || (u < -kFlat && v < -kFlat && w < -kFlat);
}

// Edges of a part that go through triangles of the same one.
int self_crossings(const TriMesh& mesh) {
    const Components parts = surface_components(mesh);
    std::vector<std::vector<int>> of(parts.count);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        of[parts.triangle_component[t]].push_back(static_cast<int>(t));
    }
    int count = 0;
    for (const std::vector<int>& part : of) {
        for (int t : part) {
            const Corners& own = mesh.triangle[t];
            for (int other : part) {
                const Corners& c = mesh.triangle[other];
                for (int k = 0; k < 3; ++k) {
                    const int from = own[k], to = own[(k + 1) % 3];
                    if (from > to) continue;
                    const auto has = [&](int v) { return v == c[0] || v == c[1] || v == c[2]; };
                    if (has(from) || has(to)) continue;
                    count +=
                        pierces(mesh.position[from], mesh.position[to],
                                {mesh.position[c[0]], mesh.position[c[1]], mesh.position[c[2]]});
                }
            }
        }
    }
    return count;
}

// Where break faces have vertices.
std::set<std::array<double, 3>> break_places(const BrokenSkin& skin) {
    std::set<std::array<double, 3>> places;
    for (std::size_t t = 0; t < skin.mesh.triangle.size(); ++t) {
        if (!is_cut(skin.mesh, t)) continue;
        for (int v : skin.mesh.triangle[t]) places.insert(key(skin.mesh.position[v]));
    }
    return places;
}

}  // namespace

TEST_CASE("a warp is undone by its inverse, and turns nothing inside out") {
    const Lattice lattice = test::make_block(3, 3, 3, .05, Material{}).lattice;
    const Warp warp(lattice, kMostRoughness);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-.3, .3);
    double worst = 0, farthest = 0, least = 1;
    for (int n = 0; n < 20000; ++n) {
        const Vec3 at(any(random), any(random), any(random));
        const Vec3 rough = warp.rough(at);
        worst = std::max(worst, (warp.straight(rough) - at).norm());
        farthest = std::max(farthest, (rough - at).norm());
        Mat3 slope;
        for (int d = 0; d < 3; ++d) {
            const Vec3 step = 1e-6 * Vec3::Unit(d);
            slope.col(d) = (warp.rough(at + step) - warp.rough(at - step)) / 2e-6;
        }
        least = std::min(least, slope.determinant());
    }
    CHECK(worst < 1e-6 * lattice.spacing);
    CHECK(farthest <= kMostRoughness * lattice.spacing);
    CHECK(farthest > 0.8 * kMostRoughness * lattice.spacing);
    CHECK(least > 0.05);
}

TEST_CASE("rough faces close pieces of all the volume, none inside out", "[stress]") {
    Fixture f = test::body(GENERATE(0, 1));
    if (GENERATE(false, true)) f.mesh = divide_edges(f.mesh, 1.5 * f.matter.lattice.spacing);
    f.mount = mount_mesh(f.mesh.position, f.matter, SkinKind::mount);
    const double a = f.matter.lattice.spacing, whole = signed_volume(f.mesh);
    test::break_at_random(f.matter, GENERATE(.02, .2, .5, .9, 1.));
    f.break_it(GENERATE(kRough, kMostRoughness));
    const TriMesh& mesh = f.broken.mesh;
    CHECK(f.broken.open_faces == 0);
    CHECK(test::is_closed(mesh));
    CHECK(signed_volume(mesh) == Approx(whole).epsilon(1e-9));
    for (double volume : volumes(mesh, surface_components(mesh))) CHECK(volume > -1e-9 * a * a * a);
    CHECK(share_of_slivers(mesh, a) < .01);
    for (std::size_t v = 0; v < f.mesh.position.size(); ++v) {
        CHECK(mesh.position[v] == f.mesh.position[v]);
    }
    const TriangleTree outside(f.mesh);
    double off = 0, area = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        if (is_cut(mesh, t)) continue;
        for (int v : mesh.triangle[t]) {
            off = std::max(off, outside.distance(mesh.position[v]));
        }
        area += area_vector(mesh.position, mesh.triangle[t]).norm() / 2;
    }
    CHECK(off < 1e-12);
    CHECK(area == Approx(surface_area(f.mesh)).epsilon(1e-12));
}

TEST_CASE("both sides of a rough break have their faces at the same places, and part whole") {
    Fixture f = test::body(GENERATE(0, 1));
    const Vec3 n = GENERATE(Vec3(1, 0, 0), Vec3(1, .31, -.44), Vec3(1, 1, 1)).normalized();
    const Vec3 point(.0371, .011, -.0083);
    test::break_along(f.matter, point, n);
    f.break_it(kRough);
    const TriMesh& mesh = f.broken.mesh;
    std::multiset<std::set<std::array<double, 3>>> face[2];
    const Components parts = surface_components(mesh);
    REQUIRE(parts.count == 2);
    double flat = 0, all = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        if (!is_cut(mesh, t)) continue;
        const Corners& c = mesh.triangle[t];
        face[parts.triangle_component[t]].insert(
            {key(mesh.position[c[0]]), key(mesh.position[c[1]]), key(mesh.position[c[2]])});
        const Vec3 area = area_vector(mesh.position, c);
        all += area.norm();
        if (area.normalized().cwiseAbs().maxCoeff() > .9999) flat += area.norm();
    }
    CHECK(!face[0].empty());
    CHECK(face[0] == face[1]);
    CHECK(flat < .02 * all);

    test::deform(f.matter,
                 [&](const Vec3& p) -> Vec3 { return n.dot(p - point) >= 0 ? Vec3(p + n) : p; });
    const TriMesh moved = f.now();
    double worst = 0;
    std::array<double, 2> rode = {0, 0};
    for (std::size_t t = 0; t < moved.triangle.size(); ++t) {
        for (int v : moved.triangle[t]) {
            const Vec3 way = moved.position[v] - mesh.position[v];
            worst = std::max(worst, std::min(way.norm(), (way - n).norm()));
            rode[parts.triangle_component[t]] += way.norm() > .5 ? 1 : -1e9;
        }
    }
    CHECK(worst < 1e-12);
    CHECK((rode[0] > 0) != (rode[1] > 0));
}

TEST_CASE("what breaks later moves no rough face") {
    Fixture f = test::body(GENERATE(0, 1));
    test::break_along(f.matter, {.0371, .011, -.0083}, Vec3(1, .31, -.44).normalized());
    f.break_it(kRough);
    const std::set<std::array<double, 3>> before = break_places(f.broken);
    std::mt19937 random(5);
    for (int d = 0; d < 3; ++d) {
        ConnectionArrays& all = f.matter.connection[d];
        for (std::size_t p = 0; p < f.matter.particle_count(); ++p) {
            if (random() % 3 == 0 && all.weight[p] > 0) all.weight.set(p, 0), all.damage[p] = 1;
        }
    }
    f.break_it(kRough);
    const std::set<std::array<double, 3>> after = break_places(f.broken);
    CHECK(after.size() > 2 * before.size());
    CHECK(std::includes(after.begin(), after.end(), before.begin(), before.end()));
}

TEST_CASE("rough faces of a sheet or bar stay within it") {
    const double a = .05;
    const int thick = GENERATE(1, 2, 6);
    const double out = a * GENERATE(0., .3, -.3);
    Aggregate matter = test::make_block(12, thick, 8, a, Material{});
    if (out < 0) std::fill(matter.cell_fill.begin(), matter.cell_fill.end(), .5f);
    const Vec3 half = a * Vec3(6, .5 * thick, 4) + Vec3::Constant(out);
    Fixture f(std::move(matter), divide_edges(box_mesh(-half, half), GENERATE(9., .075)));
    f.mount = mount_mesh(f.mesh.position, f.matter, SkinKind::mount);
    const double whole = signed_volume(f.mesh);
    test::break_at_random(f.matter, GENERATE(.3, 1.));
    f.break_it(kRough);
    const TriMesh& mesh = f.broken.mesh;
    CHECK(f.broken.open_faces == 0);
    CHECK(test::is_closed(mesh));
    CHECK(signed_volume(mesh) == Approx(whole).epsilon(1e-9));
    double beyond = 0;
    for (const Vec3& p : mesh.position) {
        beyond = std::max(beyond, (p.cwiseAbs() - half).maxCoeff());
    }
    CHECK(beyond < 1e-12);
    for (double volume : volumes(mesh, surface_components(mesh))) CHECK(volume > -1e-9 * a * a * a);
}

TEST_CASE("rubble of rough faces does not go through itself") {
    Fixture f = test::body(GENERATE(0, 1));
    f.mesh = divide_edges(f.mesh, 1.5 * f.matter.lattice.spacing);
    f.mount = mount_mesh(f.mesh.position, f.matter, SkinKind::mount);
    test::break_at_random(f.matter, 1);
    f.break_it(kRough);
    CHECK(self_crossings(f.broken.mesh) == 0);
}

TEST_CASE("what a blade has cut and load breaks roughly is closed, all volume kept", "[stress]") {
    Fixture f = test::body(GENERATE(0, 1));
    const Vec3 n = GENERATE(Vec3(1, 0, 0), Vec3(1, .31, -.44), Vec3(1, 1, 1)).normalized();
    const Vec3 point = GENERATE(Vec3(.0171, .0213, -.0083), Vec3(.025, .025, -.025));
    const Vec3 u = n.cross(Vec3::UnitZ()).normalized();
    const double whole = signed_volume(f.mesh);
    f.cut(point, u, n.cross(u), true);
    test::sever_plane(f.matter, point, n);
    const double share = GENERATE(0., .05, .5);
    if (share == 0) {
        test::break_along(f.matter, {.0371, .011, -.0083}, Vec3(.2, 1, -.44).normalized());
    } else {
        test::break_at_random(f.matter, share);
    }
    f.break_it(kRough);
    CHECK(f.broken.open_faces == 0);
    CHECK(test::is_closed(f.broken.mesh));
    CHECK(signed_volume(f.broken.mesh) == Approx(whole).epsilon(1e-9));
}

TEST_CASE("a boundary is rough where load broke it, and plane where a blade did") {
    Aggregate matter = test::body(GENERATE(0, 1)).matter;
    const Vec3 n = Vec3(1, .31, -.44).normalized(), point(.0371, .011, -.0083);
    SECTION("blade") {
        test::sever_plane(matter, point, n);
        const TriMesh plain = boundary_skin(matter).mesh;
        CHECK(boundary_skin(matter, nullptr, kRough).mesh.position == plain.position);
    }
    SECTION("load") {
        test::break_along(matter, point, n);
        const TriMesh plain = boundary_skin(matter).mesh;
        const TriMesh rough = boundary_skin(matter, nullptr, kRough).mesh;
        CHECK(test::is_closed(rough));
        CHECK(signed_volume(rough) == Approx(signed_volume(plain)).epsilon(1e-3));
        REQUIRE(rough.triangle.size() == plain.triangle.size());
        const auto off = [&](const TriMesh& mesh) {
            double most = 0;
            for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
                for (int v : mesh.triangle[t]) {
                    if (!is_cut(mesh, t)) continue;
                    most = std::max(most, std::abs(n.dot(mesh.position[v] - point)));
                }
            }
            return most / matter.lattice.spacing;
        };
        CHECK(off(rough) > off(plain) + .1);
        CHECK(off(rough) < off(plain) + kRough * 1.4);
        // Between the two pieces there is nothing.
        const Components parts = surface_components(rough);
        REQUIRE(parts.count == 2);
        std::multiset<std::set<std::array<double, 3>>> face[2];
        for (std::size_t t = 0; t < rough.triangle.size(); ++t) {
            if (!is_cut(rough, t)) continue;
            std::set<std::array<double, 3>> corner;
            for (int v : rough.triangle[t]) corner.insert(key(rough.position[v]));
            face[parts.triangle_component[t]].insert(corner);
        }
        CHECK(!face[0].empty());
        CHECK(face[0] == face[1]);
    }
}
