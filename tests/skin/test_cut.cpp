// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/skin/cut_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

// How far a part goes below and above a plane, 0 where it does not [m].
std::pair<double, double> reach_of(const TriMesh& part, const Vec3& point, const Vec3& normal) {
    double low = 0, high = 0;
    for (const Corners& t : part.triangle) {
        for (int v : t) {
            const double h = normal.dot(part.position[v] - point);
            low = std::min(low, h), high = std::max(high, h);
        }
    }
    return {low, high};
}

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
    CHECK(result.cuts == 1);
    CHECK(result.open_parts == 0);
    CHECK(cap_triangles(f.mesh) > 0);
    check_sound(f.mesh, f.position);
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    CHECK(parts.size() >= 2);
    double sum = 0;
    for (const TriMesh& part : parts) {
        CHECK(test::is_closed(part));
        CHECK(signed_volume(part) > 0);
        sum += signed_volume(part);
    }
    CHECK(sum == Approx(whole).epsilon(1e-9));

    SECTION("each half lies on its own side of the plane") {
        for (const TriMesh& part : parts) {
            const auto [low, high] = reach_of(part, point, normal.normalized());
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
    f.bend();
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
    CHECK(result.cuts == 1);
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
    CHECK(cap_triangles(f.mesh) > 0);
    CHECK(test::is_closed(f.mesh));
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    CHECK(parts.size() == 2);
    double sum = 0;
    for (const TriMesh& part : parts) sum += signed_volume(part);
    CHECK(sum == Approx(whole).epsilon(1e-9));
}

TEST_CASE("sheets that lie back to back within a body are cut with it, and bind nothing together") {
    // The bar as two that share a face, given by both.
    TriMesh two = bar();
    const double whole = signed_volume(two);
    std::map<std::pair<int, int>, int> at;
    const auto grid = [](double x) { return int(std::lround(x * 30 + 4.5)); };
    for (std::size_t v = 0; v < two.position.size(); ++v) {
        const Vec3& p = two.position[v];
        if (std::abs(p.x()) < 1e-9) at[{grid(p.y()), grid(p.z())}] = int(v);
    }
    const auto vertex = [&](int j, int k) {
        const auto [entry, fresh] = at.emplace(std::pair(j, k), int(two.position.size()));
        if (fresh) two.position.push_back({0, (j - 4.5) / 30, (k - 4.5) / 30});
        return entry->second;
    };
    for (int j = 0; j < 9; ++j) {
        for (int k = 0; k < 9; ++k) {
            const int a = vertex(j, k), b = vertex(j + 1, k), c = vertex(j + 1, k + 1),
                      d = vertex(j, k + 1);
            for (const Corners& t : {Corners{a, b, c}, {a, c, b}, {a, c, d}, {a, d, c}}) {
                two.triangle.push_back(t);
            }
        }
    }
    const auto [point, normal] = GENERATE(table<Vec3, Vec3>({
        {Vec3(0, .0123, 0), Vec3(.02, 1, .3)},
        {Vec3(.03, 0, 0), Vec3(1, .4, -.7)},
        {Vec3(0, 0, 0), Vec3(1, 0, 0)},  // along the sheets
    }));
    Fixture f(two);
    f.cut(sweep_of(point, normal.normalized(), 3));
    for_each_edge(edge_uses(f.mesh.triangle, f.mesh.position.size()),
                  [](auto uses) { CHECK(excess(uses) == 0); });
    CHECK(signed_volume(f.mesh) == Approx(whole).epsilon(1e-9));
    int above = 0, below = 0;
    for (const TriMesh& part : parts_of(f.mesh)) {
        const auto [low, high] = reach_of(part, point, normal.normalized());
        CHECK(std::min(-low, high) < 0.01 * 0.05);
        ++(high > -low ? above : below);
    }
    CHECK(above > 0);
    CHECK(below > 0);
}

TEST_CASE("an open surface is cut but not capped") {
    TriMesh open = bar();
    open.triangle.resize(open.triangle.size() / 2);
    Fixture f(open);
    const CutResult result = f.cut(sweep_of({.0137, 0, 0}, Vec3::UnitY(), 3));
    CHECK(result.open_parts == 1);
    CHECK(cap_triangles(f.mesh) == 0);
}

TEST_CASE("a blade that cuts, draws back, goes aside in the air and cuts again cuts twice") {
    Fixture f(bar());
    const double whole = signed_volume(f.mesh);
    const auto strip = [](const Vec3& from, const Vec3& to) -> Sweep {
        const Vec3 far(0, 0, 1), edge = 2 * far;
        const Vec3 a = from - far, b = to - far;
        return {{a, b, b + edge}, {a, b + edge, a + edge}};
    };
    Sweep sweep;
    // Back by other steps than down, and so of several sweeps in one plane.
    const std::vector<Vec3> way = {
        {-.1237, .6, 0},  {-.1237, .4, 0},  {-.1237, -.4, 0}, {-.1237, -.5, 0}, {-.1237, -.41, 0},
        {-.1237, .37, 0}, {-.1237, .61, 0}, {.2137, .61, 0},  {.2137, .4, 0},   {.2137, -.5, 0}};
    for (std::size_t n = 0; n + 1 < way.size(); ++n) {
        const Sweep leg = strip(way[n], way[n + 1]);
        sweep.insert(sweep.end(), leg.begin(), leg.end());
    }
    const CutResult result = f.cut(sweep);
    CHECK_FALSE(result.has_folded);
    CHECK(result.cuts == 2);
    CHECK(result.open_parts == 0);
    check_sound(f.mesh, f.position);
    CHECK(parts_of(f.mesh).size() == 3);
    CHECK(signed_volume(f.mesh) == Approx(whole).epsilon(1e-9));
}

TEST_CASE("after a sweep that folds, triangles between two pieces are taken out") {
    Fixture f(bar());
    const Vec3 a(0, -1, -1), b(0, 0, -1), c(.2, -1, -1), up(0, 0, 2);
    const CutResult result = f.cut({{a, b, b + up}, {a, b + up, a + up}, {b, c, c + up}});
    CHECK(result.has_folded);
    CHECK(result.cuts == 0);
    test::sever_plane(f.matter, {.0137, 0, 0}, Vec3::UnitX());
    const std::size_t before = f.mesh.triangle.size();
    remove_torn_triangles(f.mesh, f.mount, f.matter);
    CHECK(f.mesh.triangle.size() < before);
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
    REQUIRE(result.cuts == 1);
    test::sever_plane(f.matter, {.02, 0, 0}, Vec3::UnitX());
    for (std::size_t p = 0; p < f.matter.particle_count(); ++p) {
        if (f.matter.particle_reference.at(p).x() > .02) {
            f.matter.particle_position.add(p, {.2, 0, 0});
        }
    }
    f.follow();
    CHECK(test::is_closed(f.mesh));
    double volume = 0;
    int of_foot = 0;
    for (const TriMesh& part : parts_of(f.mesh)) {
        TriMesh moved = part;
        moved.position = f.position;
        volume += signed_volume(moved);
        Box box;
        for (const Corners& t : part.triangle) {
            for (int v : t) box.grow(f.position[v]);
        }
        if (box.low.y() >= -.16) continue;
        ++of_foot;
        CHECK(box.low.x() > .2);  // all went together
    }
    CHECK(of_foot == 2);  // the sliver and the rest
    CHECK(volume == Approx(whole).epsilon(1e-6));
}
