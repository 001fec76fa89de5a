// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/diced_skin.h"
#include "skin/divided_mesh.h"
#include "tests/skin/broken_fixture.h"

using namespace swage;

namespace {

using test::ball, test::bar, test::body;
using test::break_along, test::break_at_random, test::break_where;
using test::least_volume, test::thinnest;
using Fixture = test::BrokenFixture;

// Of a cut: through the body, made in the skin alone so far, or up to a line inside.
enum class Extent { whole, ahead, inside };

}  // namespace

TEST_CASE("a diced skin is the skin, each triangle around one particle") {
    const Fixture f = body(GENERATE(0, 1));
    const bool part = GENERATE(false, true);
    const auto wanted = [&](const Vec3i& site) { return !part || site.x() == 4; };
    const DicedSkin diced = dice_skin(f.mesh, f.matter.lattice, {}, wanted);
    CHECK(test::is_closed(diced.mesh));
    CHECK(signed_volume(diced.mesh) == Approx(signed_volume(f.mesh)).epsilon(1e-12));
    CHECK(surface_area(diced.mesh) == Approx(surface_area(f.mesh)).epsilon(1e-12));
    double outside = 0, off = 0;
    for (std::size_t t = 0; t < diced.mesh.triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const Vec3 p = diced.mesh.position[diced.mesh.triangle[t][k]];
            for (int d = 0; d < 3 && diced.site[t] != kNoSite; ++d) {
                outside = std::max(outside, p[d] - diced.planes.at(d, diced.site[t][d]));
                outside = std::max(outside, diced.planes.at(d, diced.site[t][d] - 1) - p[d]);
            }
            if (diced.mesh.triangle_uv.empty()) continue;
            const Vec2 uv = diced.mesh.uv[diced.mesh.triangle_uv[t][k]];
            off = std::max(off, (uv - Vec2(p.x() + 2 * p.y(), p.z() - p.x())).norm());
        }
    }
    const auto left = std::count(diced.site.begin(), diced.site.end(), kNoSite);
    CHECK((left > 0) == part);
    CHECK(outside < 1e-14);
    CHECK(off < 1e-14);
}

TEST_CASE("what broke in two shows two closed surfaces that move on their own, all volume kept") {
    Fixture f = body(GENERATE(0, 1));
    const Vec3 n = GENERATE(Vec3(1, 0, 0), Vec3(1, .5, 0), Vec3(1, .31, -.44), Vec3(1, 1, 1),
                            Vec3(0, 1, 0), Vec3(.1, .2, 1))
                       .normalized();
    const Vec3 point(.0371, .011, -.0083);
    const double whole = signed_volume(f.mesh);
    break_along(f.matter, point, n);
    REQUIRE(find_pieces(f.matter).count == 2);
    f.break_it();
    CHECK(f.broken.open_faces == 0);
    CHECK(f.broken.faces > 0);
    CHECK(test::is_closed(f.broken.mesh));
    CHECK(surface_components(f.broken.mesh).count == 2);
    CHECK(signed_volume(f.broken.mesh) == Approx(whole).epsilon(1e-9));
    for (std::size_t v = 0; v < f.mesh.position.size(); ++v) {
        CHECK(f.broken.mesh.position[v] == f.mesh.position[v]);
    }
    const Quat turn(Eigen::AngleAxisd(.7, Vec3(1, 2, 3).normalized()));
    test::deform(f.matter, [&](const Vec3& p) -> Vec3 {
        return n.dot(p - point) >= 0 ? Vec3(turn * p + n) : p;
    });
    const TriMesh moved = f.now();
    CHECK(signed_volume(moved) == Approx(whole).epsilon(1e-9));
    const Components parts = surface_components(moved);
    double worst = 0;
    std::array<double, 2> rides = {0, 0};
    for (std::size_t t = 0; t < moved.triangle.size(); ++t) {
        for (int v : moved.triangle[t]) {
            const Vec3 p = f.broken.mesh.position[v];
            const double stays = (moved.position[v] - p).norm();
            const double rode = (moved.position[v] - (turn * p + n)).norm();
            worst = std::max(worst, std::min(stays, rode));
            rides[parts.triangle_component[t]] += rode < stays ? 1 : -1e9;
        }
    }
    CHECK(worst < 1e-12);
    CHECK((rides[0] > 0) != (rides[1] > 0));
}

TEST_CASE("what lay within an object that breaks is of that object, not of another") {
    const double roughness = GENERATE(0., .25);
    // Of two bars beside each other the second alone breaks into crumbs.
    Aggregate matter =
        test::make_shape([](const Vec3& p) { return std::abs(p.x()) < .1 ? 1. : -1.; },
                         Vec3(-.5, -.15, -.15), Vec3i(20, 6, 6), .05);
    TriMesh mesh = test::together(box_mesh(Vec3(-.5, -.15, -.15), Vec3(-.1, .15, .15)),
                                  box_mesh(Vec3(.1, -.15, -.15), Vec3(.5, .15, .15)));
    mesh.part_name = {"left", "right"};
    for (const Corners& t : mesh.triangle) {
        mesh.triangle_part.push_back(mesh.position[t[0]].x() > 0);
    }
    Fixture f(std::move(matter), std::move(mesh));
    break_where(f.matter, [](const Vec3& p, const Vec3&) { return p.x() > 0; });
    f.break_it(roughness);
    CHECK(f.broken.open_faces == 0);
    REQUIRE(f.broken.faces > 0);
    int astray = 0;
    for (std::size_t t = 0; t < f.broken.mesh.triangle.size(); ++t) {
        const double x = f.broken.mesh.position[f.broken.mesh.triangle[t][0]].x();
        astray += f.broken.mesh.triangle_part[t] != (x > 0);
    }
    CHECK(astray == 0);
}

TEST_CASE("a box whose edges and faces lie half-way between sites breaks without slivers") {
    const double a = .05, out = a * GENERATE(0., .5, -.5);
    Fixture f = bar();
    if (out < 0) std::fill(f.matter.cell_fill.begin(), f.matter.cell_fill.end(), .5f);
    const Vec3 half = Vec3(.5 + out, .15 + out, .15 + out);
    // Halved edges come to lie in middle planes, their diagonals run through corners of cubes.
    f.mesh = divide_edges(box_mesh(-half, half), GENERATE(3., .2, .1, .04));
    f.mount = mount_mesh(f.mesh.position, f.matter, SkinKind::mount);
    const double whole = signed_volume(f.mesh);
    const bool is_cut = GENERATE(false, true);
    if (is_cut) {
        f.cut({.025, .025, -.025}, Vec3::UnitY(), Vec3::UnitZ(), true);
        test::sever_plane(f.matter, {.025, .025, -.025}, Vec3::UnitX());
    }
    const double share = GENERATE(.05, 1.);
    break_at_random(f.matter, share);
    f.break_it();
    CHECK(f.broken.open_faces == 0);
    CHECK(test::is_closed(f.broken.mesh));
    CHECK(signed_volume(f.broken.mesh) == Approx(whole).epsilon(1e-9));
    // NOTE: between a cut and the plane beside it what edges the cut has are all that there is.
    CHECK(thinnest(f.broken.mesh) > (is_cut ? 5e-5 : 1e-3) * a);
    // Else cracks inside that reach no surface are sheets of no volume.
    if (share == 1) CHECK(least_volume(f.broken.mesh) > 1e-3 * a * a * a);
}

TEST_CASE("a crack that ends inside is a slit, and opens like a mouth") {
    Fixture f = body(GENERATE(0, 1));
    const double whole = signed_volume(f.mesh);
    break_where(f.matter, [](const Vec3& p, const Vec3& q) {
        return (p.x() > .013) != (q.x() > .013) && p.y() + q.y() > .02;
    });
    f.break_it();
    CHECK(f.broken.faces > 0);
    CHECK(f.broken.open_faces == 0);
    CHECK(test::is_closed(f.broken.mesh));
    CHECK(surface_components(f.broken.mesh).count == 1);
    CHECK(signed_volume(f.broken.mesh) == Approx(whole).epsilon(1e-9));
    test::deform(f.matter, [](const Vec3& p) -> Vec3 {
        const double open = .2 * std::max(0., p.y() - .01);
        return p + Vec3(p.x() > .013 ? open : -open, 0, 0);
    });
    CHECK(signed_volume(f.now()) == Approx(whole).epsilon(2e-2));  // of big flat triangles
}

TEST_CASE(
    "matter broken anywhere, down to single particles, shows closed surfaces of all its volume") {
    Fixture f = body(GENERATE(0, 1));
    const double share = GENERATE(.02, .2, .5, .9, 1.);
    break_at_random(f.matter, share);
    f.break_it();
    CHECK(f.broken.open_faces == 0);
    CHECK(test::is_closed(f.broken.mesh));
    CHECK(signed_volume(f.broken.mesh) == Approx(signed_volume(f.mesh)).epsilon(1e-9));
    std::mt19937 shake(6);
    test::deform(f.matter, [&](const Vec3& p) -> Vec3 {
        return p + .01 * Vec3(shake() % 7, shake() % 7, shake() % 7);
    });
    for (const Vec3& p : f.now().position) CHECK(p.allFinite());
}

TEST_CASE("rubble is closed too where the surface comes as near to a cut as its two faces are") {
    const unsigned seed = GENERATE(89u, 113u, 137u);
    Fixture f(ball().matter, test::sphere_mesh(.5, 3));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-1, 1);
    for (Vec3& p : f.mesh.position) p += 2e-3 * Vec3(any(random), any(random), any(random));
    f.mount = mount_mesh(f.mesh.position, f.matter, SkinKind::mount);
    const Vec3 n = Vec3(1, .31, -.44).normalized(), point(.025, .025, -.025);
    const Vec3 u = n.cross(Vec3::UnitZ()).normalized();
    f.cut(point, u, n.cross(u), true);
    test::sever_plane(f.matter, point, n);
    std::mt19937 draw(5);
    break_where(f.matter,
                [&](const Vec3&, const Vec3&) { return draw() < .5 * std::mt19937::max(); });
    f.break_it();
    CHECK(f.broken.open_faces == 0);
    CHECK(test::is_closed(f.broken.mesh));
}

TEST_CASE("what a blade has cut and load breaks shows closed surfaces, all volume kept",
          "[stress]") {
    const int number = GENERATE(0, 1);
    Fixture f = body(number);
    const Extent extent = GENERATE(Extent::whole, Extent::ahead, Extent::inside);
    const Vec3 n = GENERATE(Vec3(1, 0, 0), Vec3(1, .31, -.44), Vec3(1, 1, 1)).normalized();
    // Anywhere, and exactly half-way between sites.
    const Vec3 point = GENERATE(Vec3(.0171, .0213, -.0083), Vec3(.025, .025, -.025));
    const Vec3 u = n.cross(Vec3::UnitZ()).normalized();
    const double whole = signed_volume(f.mesh);
    f.cut(point, u, n.cross(u), extent != Extent::inside);
    if (extent != Extent::ahead) {
        test::sever_plane(f.matter, point, n, [&](const Vec3& p) {
            return extent == Extent::whole || u.dot(p - point) > 0;
        });
    }
    const int way = GENERATE(0, 1, 2, 3);  // along the lattice, aslant, here and there, nearly all
    if (way < 2) {
        break_along(f.matter, {.0371, .011, -.0083},
                    way == 0 ? Vec3(0, 1, 0) : Vec3(.2, 1, -.44).normalized());
    } else {
        std::mt19937 random(5);
        break_where(f.matter, [&](const Vec3&, const Vec3&) {
            return random() < (way == 2 ? .05 : .5) * std::mt19937::max();
        });
    }
    f.break_it();
    CHECK(signed_volume(f.broken.mesh) == Approx(whole).epsilon(1e-9));
    // NOTE: at the end of a cut inside the body single edges may stay open or have four faces.
    if (extent == Extent::inside) return;
    CHECK(f.broken.open_faces == 0);
    CHECK(test::is_closed(f.broken.mesh));

    // Pieces move apart, each taking its own surface along.
    const Pieces pieces = find_pieces(f.matter);
    for (std::size_t p = 0; p < f.matter.particle_count(); ++p) {
        const int piece = pieces.particle_piece[p];
        f.matter.particle_position.add(p, {1.0 * piece, 0.3 * (piece % 7), 0.7 * (piece % 3)});
    }
    const TriMesh moved = f.now();
    double torn = 0;
    for (const Corners& c : moved.triangle) {
        const auto edge = [&](const TriMesh& mesh, int k) -> Vec3 {
            return mesh.position[c[(k + 1) % 3]] - mesh.position[c[k]];
        };
        double most = 0;
        for (int k = 0; k < 3; ++k) {
            most = std::max(most, (edge(moved, k) - edge(f.broken.mesh, k)).norm());
        }
        if (most > 1e-9) torn += edge(f.broken.mesh, 0).cross(edge(f.broken.mesh, 1)).norm() / 2;
    }
    torn /= surface_area(f.broken.mesh);
    CHECK(torn == 0);
}

TEST_CASE("new faces carry no texture, the old surface keeps its own, also along the break") {
    Fixture f = bar();
    break_along(f.matter, {.0371, .011, -.0083}, Vec3(1, .31, -.44).normalized());
    f.break_it();
    const TriMesh& mesh = f.broken.mesh;
    double off = 0, area = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const Corners& c = mesh.triangle[t];
        const Vec3 p = mesh.position[c[0]];
        const bool is_new = mesh.material[mesh.triangle_material[t]].name == kCutMaterial;
        for (int k = 0; k < 3; ++k) {
            CHECK((mesh.triangle_uv[t][k] < 0) == is_new);
            if (is_new) continue;
            const Vec3 at = mesh.position[c[k]];
            off = std::max(
                off, (mesh.uv[mesh.triangle_uv[t][k]] - Vec2(at.x() + 2 * at.y(), at.z() - at.x()))
                         .norm());
        }
        if (!is_new) {
            area += (mesh.position[c[1]] - p).cross(mesh.position[c[2]] - p).norm() / 2;
        }
    }
    CHECK(off < 1e-14);
    CHECK(area == Approx(surface_area(f.mesh)).epsilon(1e-12));
    for (const Vec3& n : smooth_normals(mesh, mesh.position)) CHECK(n.allFinite());
}
