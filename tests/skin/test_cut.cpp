// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <random>
#include <set>

#include "geometry/triangle_tree.h"
#include "skin/cut_mesh.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

using Sweep = std::vector<std::array<Vec3, 3>>;

// A rectangle in the plane, `reach` wide to every side.
Sweep sweep_of(const Vec3& point, const Vec3& normal, double reach) {
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u).normalized();
    const auto at = [&](double s, double t) -> Vec3 { return point + reach * (s * u + t * v); };
    return {{at(-1, -1), at(1, -1), at(1, 1)}, {at(-1, -1), at(1, 1), at(-1, 1)}};
}

// The surface of a grid of squares, closed: a box, or a tube with a square hole along x.
TriMesh box_mesh(const Vec3& half, const Vec3i& division, bool hollow) {
    TriMesh mesh;
    std::map<std::array<int, 3>, int> id;
    const auto vertex = [&](const Vec3i& at) {
        const auto [entry, fresh] = id.emplace(std::array<int, 3>{at[0], at[1], at[2]},
                                               static_cast<int>(mesh.position.size()));
        if (fresh) {
            mesh.position.push_back(half.cwiseProduct(
                2 * at.cast<double>().cwiseQuotient(division.cast<double>()) - Vec3::Ones()));
        }
        return entry->second;
    };
    const auto solid = [&](const Vec3i& c) {
        if ((c.array() < 0).any() || (c.array() >= division.array()).any()) return false;
        return !hollow || c[1] < division[1] / 3 || c[1] >= division[1] - division[1] / 3 ||
               c[2] < division[2] / 3 || c[2] >= division[2] - division[2] / 3;
    };
    for (int k = 0; k < division[2]; ++k)
        for (int j = 0; j < division[1]; ++j)
            for (int i = 0; i < division[0]; ++i) {
                const Vec3i cell(i, j, k);
                if (!solid(cell)) continue;
                for (int axis = 0; axis < 3; ++axis)
                    for (int end = 0; end < 2; ++end) {
                        const Vec3i way = (end ? 1 : -1) * Vec3i::Unit(axis);
                        if (solid(cell + way)) continue;
                        const Vec3i low = cell + end * Vec3i::Unit(axis);
                        const Vec3i u = Vec3i::Unit((axis + 1) % 3),
                                    v = Vec3i::Unit((axis + 2) % 3);
                        std::array<int, 4> q = {vertex(low), vertex(low + u), vertex(low + u + v),
                                                vertex(low + v)};
                        if (!end) std::swap(q[1], q[3]);
                        mesh.triangle.push_back({q[0], q[1], q[2]});
                        mesh.triangle.push_back({q[0], q[2], q[3]});
                    }
            }
    return mesh;
}

// Texture coordinates that are a linear function of the place, smoothing, parts, polygons.
void dress(TriMesh& mesh) {
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        Corners uv;
        for (int k = 0; k < 3; ++k) {
            const Vec3& p = mesh.position[mesh.triangle[t][k]];
            uv[k] = static_cast<int>(mesh.uv.size());
            mesh.uv.push_back({p.x() + 2 * p.y(), p.z() - p.x()});
        }
        mesh.triangle_uv.push_back(uv);
        mesh.triangle_polygon.push_back(static_cast<int>(t / 2));
        mesh.triangle_part.push_back(0);
    }
    mesh.part_name = {"body"};
    smooth_by_crease_angle(mesh, 0.6);
}

void check_sound(const TriMesh& mesh, const std::vector<Vec3>& position) {
    CHECK(fixtures::is_closed(mesh));
    std::set<Corners> seen;
    double least_area = 1e30;
    for (Corners t : mesh.triangle) {
        const Vec3 area = (position[t[1]] - position[t[0]]).cross(position[t[2]] - position[t[0]]);
        least_area = std::min(least_area, area.norm());
        std::sort(t.begin(), t.end());
        CHECK(seen.insert(t).second);
    }
    CHECK(least_area > 1e-9);
}

// The parts of the surface as meshes.
std::vector<TriMesh> parts_of(const TriMesh& mesh) {
    const Components components = surface_components(mesh);
    std::vector<TriMesh> parts(components.count);
    for (TriMesh& part : parts) part.position = mesh.position;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        parts[components.triangle_component[t]].triangle.push_back(mesh.triangle[t]);
    }
    return parts;
}

struct Fixture {
    Aggregate matter = test::make_block(20, 6, 6, 0.05, Material{});  // 1 x 0.3 x 0.3
    TriMesh mesh;
    Mount mount;
    std::vector<Vec3> position;

    explicit Fixture(TriMesh made) : mesh(std::move(made)) {
        dress(mesh);
        mount = mount_mesh(mesh.position, matter, SkinKind::mount);
        follow();
    }
    void follow() { skin_positions(mount, matter, position); }
    CutResult cut(const Sweep& sweep) {
        const CutResult result = cut_skin(mesh, position, mount, matter, sweep);
        follow();
        return result;
    }
};

TriMesh bar(bool hollow = false) { return box_mesh({.5, .15, .15}, {24, 9, 9}, hollow); }

}  // namespace

TEST_CASE("a cut through gives closed halves whose volumes add up to the whole") {
    const bool hollow = GENERATE(false, true);
    const auto [point, normal] = GENERATE(table<Vec3, Vec3>({
        {Vec3(.0137, 0, 0), Vec3(1, 0, 0)},
        {Vec3(0, 0, 0), Vec3(1, 0, 0)},        // through vertices
        {Vec3(1. / 24, 0, 0), Vec3(1, 1, 0)},  // through vertices and along diagonals
        {Vec3(.02, .01, -.03), Vec3(1, .4, -.7)},
        {Vec3(0, .0123, 0), Vec3(.02, 1, .3)},  // along the bar
        {Vec3(.1, .15, .15), Vec3(1, 1, 1)},
    }));
    Fixture f(bar(hollow));
    const double whole = signed_volume(f.mesh);
    const CutResult result = f.cut(sweep_of(point, normal.normalized(), 3));
    CHECK(result.planes == 1);
    CHECK(result.open_parts == 0);
    CHECK(result.cap_triangles > 0);
    check_sound(f.mesh, f.position);
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    CHECK(parts.size() >= 2);
    double sum = 0;
    for (const TriMesh& part : parts) {
        CHECK(fixtures::is_closed(part));
        CHECK(signed_volume(part) > 0);
        sum += signed_volume(part);
    }
    CHECK(sum == Approx(whole).epsilon(1e-9));

    SECTION("each half lies on its own side of the plane") {
        for (const TriMesh& part : parts) {
            double low = 0, high = 0;
            for (const Corners& t : part.triangle) {
                for (int v : t) {
                    const double h = normal.normalized().dot(part.position[v] - point);
                    low = std::min(low, h), high = std::max(high, h);
                }
            }
            CHECK(std::min(-low, high) < 0.01 * 0.05);
        }
    }
    SECTION("texture coordinates stay the function of the place that they were") {
        REQUIRE(f.mesh.triangle_uv.size() == f.mesh.triangle.size());
        double worst = 0;
        for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const int uv = f.mesh.triangle_uv[t][k];
                CHECK((uv < 0) == (f.mesh.material[f.mesh.triangle_material[t]].name == "cut"));
                if (uv < 0) continue;
                const Vec3& p = f.mesh.position[f.mesh.triangle[t][k]];
                const Vec2 should(p.x() + 2 * p.y(), p.z() - p.x());
                worst = std::max(worst, (f.mesh.uv[uv] - should).norm());
            }
        }
        CHECK(worst < 1e-12);
    }
    SECTION("no smooth group is shared by two vertices, and caps are flat") {
        std::map<int, int> vertex_of;
        for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const int group = f.mesh.triangle_smooth[t][k], v = f.mesh.triangle[t][k];
                REQUIRE(group < f.mesh.smooth_group_count);
                CHECK(vertex_of.emplace(group, v).first->second == v);
            }
        }
        const std::vector<Vec3> normals = smooth_normals(f.mesh, f.position);
        for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
            if (f.mesh.triangle_uv[t][0] >= 0) continue;
            for (int group : f.mesh.triangle_smooth[t]) {
                CHECK(std::abs(normals[group].dot(normal.normalized())) > 0.999);
            }
        }
    }
}

TEST_CASE("a cut is not to be seen before the matter is severed") {
    Fixture f(bar());
    const auto map = [](const Vec3& p) -> Vec3 {
        const double t = 1.2 * p.x(), r = 1 / 1.2 - p.y();
        return {r * std::sin(t), 1 / 1.2 - r * std::cos(t), p.z()};
    };
    test::deform(f.matter, map);
    f.follow();
    const std::vector<Vec3> before = f.position;
    const Vec3 normal = Vec3(1, .3, .5).normalized(), point(0.02, 0.01, 0);
    f.cut(sweep_of(point, normal, 3));
    check_sound(f.mesh, f.position);
    REQUIRE(parts_of(f.mesh).size() == 2);
    for (std::size_t v = 0; v < before.size(); ++v) CHECK(before[v] == f.position[v]);
    // Every vertex of one cap lies on a vertex of the other, and on the plane.
    std::map<int, int> cap_vertices;  // vertex -> half
    const Components components = surface_components(f.mesh);
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        if (f.mesh.triangle_uv[t][0] >= 0) continue;
        for (int v : f.mesh.triangle[t]) cap_vertices[v] = components.triangle_component[t];
    }
    std::size_t alone = 0;
    double off = 0;
    for (const auto& [v, half] : cap_vertices) {
        off = std::max(off, std::abs(normal.dot(f.position[v] - point)));
        bool found = false;
        for (const auto& [w, other] : cap_vertices) {
            found = found || (half != other && (f.position[v] - f.position[w]).norm() < 1e-9);
        }
        alone += !found;
    }
    CHECK(alone == 0);
    CHECK(off < 0.01 * 0.05);
}

TEST_CASE("severed halves part without dragging the skin between them") {
    for (SkinKind kind : {SkinKind::mount, SkinKind::frame4}) {
        for (const Vec3& normal :
             {Vec3(1, 0, 0), Vec3(1, .3, .5), Vec3(1, 1, 1), Vec3(.3, 1, .1)}) {
            Fixture f(bar());
            f.mount = mount_mesh(f.mesh.position, f.matter, kind);
            const Vec3 n = normal.normalized(), point(0.0211, 0.0107, 0.0043);
            f.cut(sweep_of(point, n, 3));
            const std::vector<Vec3> before = f.position;
            test::sever_plane(f.matter, point, n);
            REQUIRE(find_pieces(f.matter).count == 2);
            const Quat turn(Eigen::AngleAxisd(.4, Vec3(0, 1, 1).normalized()));
            const Components halves = surface_components(f.mesh);
            REQUIRE(halves.count == 2);
            test::deform(f.matter, [&](const Vec3& p) -> Vec3 {
                return n.dot(p - point) >= 0 ? Vec3(turn * p + n) : p;
            });
            f.follow();
            double worst = 0;
            for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
                Vec3 middle = Vec3::Zero();
                for (int v : f.mesh.triangle[t]) middle += before[v] / 3;
                for (int v : f.mesh.triangle[t]) {
                    const bool moves = (f.position[v] - before[v]).norm() > .3;
                    const bool above = halves.triangle_component[t] == halves.triangle_component[0]
                                           ? n.dot(before[f.mesh.triangle[0][0]] - point) > 0
                                           : n.dot(before[f.mesh.triangle[0][0]] - point) <= 0;
                    CHECK(moves == above);
                    const Vec3 should = above ? Vec3(turn * before[v] + n) : before[v];
                    worst = std::max(worst, (f.position[v] - should).norm());
                }
            }
            CHECK(worst < 1e-12);
        }
    }
}

TEST_CASE("a blade that stops inside the body leaves the surface in one piece") {
    Fixture f(bar());
    const double whole = signed_volume(f.mesh);
    // From above down to y = 0.0161, through the whole depth.
    const Vec3 a(0.0137, .0161, -1), b(0.0137, .0161, 1), c(0.0137, 1, 1), d(0.0137, 1, -1);
    const CutResult result = f.cut({{a, b, c}, {a, c, d}});
    CHECK(result.planes == 1);
    CHECK(result.cap_triangles > 0);
    CHECK(parts_of(f.mesh).size() == 1);
    CHECK(fixtures::is_closed(f.mesh));
    CHECK(signed_volume(f.mesh) == Approx(whole).epsilon(1e-9));
    // It opens like a mouth when the matter does.
    test::sever_plane(f.matter, {0.0137, 0, 0}, Vec3::UnitX(),
                      [](const Vec3& p) { return p.y() > .0161; });
    test::deform(f.matter, [](const Vec3& p) -> Vec3 {
        const double open = .2 * std::max(0., p.y() - .0161);
        return p + Vec3(p.x() > .0137 ? open : -open, 0, 0);
    });
    f.follow();
    TriMesh opened = f.mesh;
    opened.position = f.position;
    // The map moves each half along x by what depends on y alone: no volume is made.
    CHECK(signed_volume(opened) == Approx(whole).epsilon(2e-3));
    double low = 1e9, high = -1e9;
    for (std::size_t v = 0; v < f.position.size(); ++v) {
        if (std::abs(f.mesh.position[v].x() - .0137) > 1e-6) continue;
        low = std::min(low, f.position[v].x());
        high = std::max(high, f.position[v].x());
    }
    CHECK(high - low == Approx(2 * .2 * (.15 - .0161)).epsilon(.05));
}

TEST_CASE("wherever a blade stops, no triangle or edge is its own other side") {
    std::mt19937 random(7);
    const auto at_random = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    // A blade that falls in steps and rises in others.
    const auto slit = [](const Vec3& from, const Vec3& edge, const Vec3& fall, int down, int up) {
        Sweep sweep;
        for (int way = 0; way < 2; ++way) {
            const int steps = way == 0 ? down : up;
            for (int n = 0; n < steps; ++n) {
                const double s0 = double(n) / steps, s1 = double(n + 1) / steps;
                const Vec3 a = from + (way == 0 ? s0 : 1 - s0) * fall;
                const Vec3 b = from + (way == 0 ? s1 : 1 - s1) * fall;
                sweep.push_back({a, a + edge, b + edge});
                sweep.push_back({a, b + edge, b});
            }
        }
        return sweep;
    };
    for (int n = 0; n < 60; ++n) {
        CAPTURE(n);
        Fixture f(bar(n % 3 == 0));
        const double whole = signed_volume(f.mesh);
        const Vec3 across = (Vec3::UnitZ() + at_random(-.3, .3) * Vec3::UnitX()).normalized();
        const Vec3 fall(at_random(-.1, .1), -at_random(.05, .3), 0);
        const double width = at_random(.002, .25);
        const Vec3 from(at_random(-.2, .2), .17, at_random(-.18, .15));
        f.cut(slit(from, width * across, fall, 1 + n % 5, 1 + n % 7));
        check_sound(f.mesh, f.mesh.position);
        CHECK(signed_volume(f.mesh) == Approx(whole).epsilon(1e-9));
        std::set<std::pair<int, int>> seen;
        for (const Corners& t : f.mesh.triangle) {
            for (int k = 0; k < 3; ++k) CHECK(seen.insert({t[k], t[(k + 1) % 3]}).second);
        }
    }
}

TEST_CASE("a body that has gone into itself is closed where it is cut, each part by its own") {
    const bool hollow = GENERATE(false, true);
    Fixture f(bar(hollow));
    const double whole = signed_volume(f.mesh);
    // A ring that is longer than its way round: one end lies half-way in the other.
    test::deform(f.matter, [](const Vec3& p) -> Vec3 {
        const double turn = 1.1 * 2 * kPi * p.x(), r = 0.35 + p.y();
        return {r * std::sin(turn), r * std::cos(turn), p.z() + 0.15 * p.x() + 0.02 * p.y()};
    });
    f.follow();
    const Vec3 point(.0013, 0, 0), normal = Vec3::UnitX();
    const CutResult result = f.cut(sweep_of(point, normal, 3));
    CHECK(result.planes == 1);
    CHECK(result.open_parts == 0);
    check_sound(f.mesh, f.position);
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    CHECK(parts.size() == 4);  // cut at the top, and each end
    double sum = 0;
    for (const TriMesh& part : parts) {
        CHECK(signed_volume(part) > 0);
        sum += signed_volume(part);
    }
    CHECK(sum == Approx(whole).epsilon(1e-9));
    double farthest = 0, off = 0;
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        if (f.mesh.triangle_uv[t][0] >= 0) continue;
        const Corners& c = f.mesh.triangle[t];
        for (int k = 0; k < 3; ++k) {
            const Vec3 edge = f.mesh.position[c[k]] - f.mesh.position[c[(k + 1) % 3]];
            farthest = std::max(farthest, edge.norm());
            off = std::max(off, std::abs(normal.dot(f.position[c[k]] - point)));
        }
    }
    CHECK(farthest < 3 * f.matter.lattice.spacing);
    CHECK(off < 0.02 * f.matter.lattice.spacing);
}

TEST_CASE("a section that crosses itself where matter has folded into itself is closed too") {
    Fixture f(bar());
    const double whole = signed_volume(f.mesh);
    // Bent by 140 degrees about a line that lies inside of it.
    test::deform(f.matter, [](const Vec3& p) -> Vec3 {
        const double k = 12, bent = std::clamp(p.x(), -.1, .1), turn = k * bent;
        const Vec3 along(std::cos(turn), std::sin(turn), 0), across(-along.y(), along.x(), 0);
        return Vec3(std::sin(turn) / k, (1 - std::cos(turn)) / k, p.z()) + (p.x() - bent) * along +
               p.y() * across;
    });
    f.follow();
    const CutResult result = f.cut(sweep_of({0, 0, .0123}, Vec3(.1, -.05, 1).normalized(), 3));
    CHECK(result.open_parts == 0);
    CHECK(result.cap_triangles > 0);
    CHECK(fixtures::is_closed(f.mesh));
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    CHECK(parts.size() == 2);
    double sum = 0;
    for (const TriMesh& part : parts) sum += signed_volume(part);
    CHECK(sum == Approx(whole).epsilon(1e-9));
}

TEST_CASE("two blades cut four closed parts out of a bar") {
    Fixture f(bar());
    const double whole = signed_volume(f.mesh);
    Sweep both = sweep_of({.013, 0, 0}, Vec3(1, .2, 0).normalized(), 3);
    for (const auto& t : sweep_of({.01, .0071, 0}, Vec3(0, 1, .1).normalized(), 3.3)) {
        both.push_back(t);
    }
    const CutResult result = f.cut(both);
    CHECK(result.planes == 2);
    check_sound(f.mesh, f.position);
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    CHECK(parts.size() == 4);
    double sum = 0;
    for (const TriMesh& part : parts) sum += signed_volume(part);
    CHECK(sum == Approx(whole).epsilon(1e-9));
}

TEST_CASE("a second stage cuts what the first one left") {
    Fixture f(bar());
    const Vec3 p1(.0137, 0, 0), n1 = Vec3::UnitX();
    f.cut(sweep_of(p1, n1, 3));
    test::sever_plane(f.matter, p1, n1);
    const Vec3 p2(0.0, .0071, 0), n2 = Vec3(0.1, 1, .1).normalized();
    f.cut(sweep_of(p2, n2, 3));
    test::sever_plane(f.matter, p2, n2);
    REQUIRE(find_pieces(f.matter).count == 4);
    check_sound(f.mesh, f.position);
    const Components parts = surface_components(f.mesh);
    REQUIRE(parts.count == 4);
    const std::vector<Vec3> before = f.position;
    const auto shift = [&](const Vec3& p) -> Vec3 {
        return Vec3(n1.dot(p - p1) >= 0 ? 1 : 0, n2.dot(p - p2) >= 0 ? 1 : 0, 0);
    };
    test::deform(f.matter, [&](const Vec3& p) -> Vec3 { return p + shift(p); });
    f.follow();
    for (int part = 0; part < parts.count; ++part) {
        Vec3 low = Vec3::Constant(1e9), high = -low;
        for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
            if (parts.triangle_component[t] != part) continue;
            for (int v : f.mesh.triangle[t]) {
                low = low.cwiseMin(f.position[v] - before[v]);
                high = high.cwiseMax(f.position[v] - before[v]);
            }
        }
        CHECK((high - low).norm() < 1e-12);
    }
}

TEST_CASE(
    "a second cut goes through the faces of the first as they are, however the matter flowed") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> noise(-.2 * .05, .2 * .05);
    for (int n = 0; n < 8; ++n) {
        CAPTURE(n);
        Fixture f(bar());
        const Vec3 p1(0.0137, 0, 0), n1 = Vec3(1, .3, .1 * n).normalized();
        f.cut(sweep_of(p1, n1, 3));
        test::sever_plane(f.matter, p1, n1);
        f.matter.cell_hardening.assign(f.matter.cell_fill.size(), 1);
        test::deform(f.matter, [&](const Vec3& p) -> Vec3 {
            return p + Vec3(noise(random), noise(random), noise(random));
        });
        f.follow();
        TriMesh before = f.mesh;
        before.position = f.position;
        double longest = 0;
        for (const Corners& t : before.triangle) {
            for (int k = 0; k < 3; ++k) {
                const Vec3 edge = f.position[t[k]] - f.position[t[(k + 1) % 3]];
                longest = std::max(longest, edge.norm());
            }
        }
        const TriangleTree surface(before);
        const CutResult result = f.cut(sweep_of({0, .0071, 0}, Vec3(.1, 1, .1).normalized(), 3));
        REQUIRE(result.cap_triangles > 0);
        // Between its ends an edge leaves its chord by a tenth of its length at most. Caps come
        // last.
        const std::size_t end =
            f.mesh.triangle.size() - static_cast<std::size_t>(result.cap_triangles);
        double worst = 0;
        for (std::size_t t = 0; t < end; ++t) {
            for (int v : f.mesh.triangle[t]) {
                if (v < static_cast<int>(before.position.size())) continue;
                worst = std::max(worst, surface.distance(f.position[v]));
            }
        }
        CHECK(worst < .1 * longest);
    }
}

TEST_CASE("an open surface is cut but not capped") {
    TriMesh open = bar();
    open.triangle.resize(open.triangle.size() / 2);
    Fixture f(open);
    const CutResult result = f.cut(sweep_of({.0137, 0, 0}, Vec3::UnitY(), 3));
    CHECK(result.open_parts == 1);
    CHECK(result.cap_triangles == 0);
}

TEST_CASE("after a curved sweep, triangles between two pieces are taken out") {
    Fixture f(bar());
    const Vec3 a(0, -1, -1), b(0, 0, -1), c(.2, 1, -1), up(0, 0, 2);
    const CutResult result = f.cut({{a, b, b + up}, {a, b + up, a + up}, {b, c, c + up}});
    CHECK(result.has_curved);
    CHECK(result.planes == 0);
    test::sever_plane(f.matter, {.0137, 0, 0}, Vec3::UnitX());
    const std::size_t before = f.mesh.triangle.size();
    const int torn = remove_torn_triangles(f.mesh, f.mount, f.matter);
    CHECK(torn > 0);
    CHECK(f.mesh.triangle.size() == before - torn);
    CHECK(f.mesh.triangle_uv.size() == f.mesh.triangle.size());
    CHECK(parts_of(f.mesh).size() == 2);
}

TEST_CASE("a chip thinner than the matter knows stays where it is cut from") {
    // Two thirds of a bar are cut off, and of a foot that stands out beyond the cut a sliver.
    TriMesh mesh = bar();
    const TriMesh foot = box_mesh({.04, .06, .04}, {4, 6, 4}, false);
    for (const Vec3& p : foot.position) mesh.position.push_back(p + Vec3(.057, -.209, 0));
    const int first = static_cast<int>(mesh.position.size() - foot.position.size());
    for (const Corners& t : foot.triangle) {
        mesh.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    Fixture f(mesh);
    const double whole = signed_volume(f.mesh);
    // The foot reaches from x = .017 on: the cut leaves 3 mm of it, a cell being 50.
    const CutResult result = f.cut(sweep_of({.02, 0, 0}, Vec3::UnitX(), 3));
    REQUIRE(result.planes == 1);
    test::sever_plane(f.matter, {.02, 0, 0}, Vec3::UnitX());
    for (std::size_t p = 0; p < f.matter.particle_count(); ++p) {
        if (f.matter.particle_reference.at(p).x() > .02) {
            f.matter.particle_position.add(p, {.2, 0, 0});
        }
    }
    f.follow();
    CHECK(fixtures::is_closed(f.mesh));
    double volume = 0;
    for (const TriMesh& part : parts_of(f.mesh)) {
        TriMesh moved = part;
        moved.position = f.position;
        volume += signed_volume(moved);
        Box box;
        for (const Corners& t : part.triangle) {
            for (int v : t) box.grow(f.position[v]);
        }
        if (box.low.y() < -.16) CHECK(box.low.x() > .2);  // of the foot, all went together
    }
    CHECK(volume == Approx(whole).epsilon(1e-6));
}
