// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts along paths that bend: of a bent edge, round a bend, and of a blade that turns.
#include <functional>
#include <random>

#include "tests/skin/cut_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

// A path over the plane x = 0: `off` says how far beside it, at (y, z). Far beyond the bar.
struct BentPath {
    std::string name;
    std::function<double(double, double)> off;

    // As blades go, never exactly through a particle.
    bool is_beyond(const Vec3& particle) const {
        const Vec3 p = particle - 0.05 * Vec3(1.3e-6, 1.7e-6, 0.9e-6);
        return p.x() > off(p.y(), p.z());
    }
};

const double kRound = 0.25;  // [m], five cells: the radius of what bends round

std::vector<BentPath> paths() {
    return {
        {"round",
         [](double y, double) {
             return std::sqrt(std::max(0.0, kRound * kRound - y * y)) - 0.2037;
         }},
        {"wave", [](double y, double) { return 0.06 * std::sin(18 * y); }},
        {"corner", [](double y, double) { return 1.2 * std::abs(y - 0.01) - 0.1; }},
        {"turned", [](double y, double z) { return 0.8 * y * z / 0.15; }},
        {"bowl", [](double y, double z) { return 3 * (y * y + z * z) - 0.1; }},
    };
}

// Squares of a tenth of a cell, so that their chords are off by less than 1e-4 m; or so many
// rows of them along z.
Sweep sweep_of(const BentPath& path, double reach = 0.23, int rows = 0) {
    Sweep sweep;
    const int count = static_cast<int>(std::lround(2 * reach / 0.005));
    if (rows == 0) rows = count;
    const auto at = [&](int i, int j) -> Vec3 {
        const double y = reach * (2.0 * i / count - 1), z = reach * (2.0 * j / rows - 1);
        return {path.off(y, z), y, z};
    };
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j < rows; ++j) {
            sweep.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            sweep.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return sweep;
}

// Of what lies on the right of it.
double volume_beyond(const BentPath& path) {
    const int count = 400;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
            const double y = 0.3 * (i + 0.5) / count - 0.15, z = 0.3 * (j + 0.5) / count - 0.15;
            sum += (0.5 - path.off(y, z)) * 0.09 / (count * count);
        }
    }
    return sum;
}

void sever_along(Aggregate& m, const BentPath& path) {
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const bool from = path.is_beyond(m.particle_position.at(span.lower + n));
            const bool to = path.is_beyond(m.particle_position.at(span.upper + n));
            if (from != to) m.connection[span.direction].weight.set(span.lower + n, 0);
        }
    }
}

bool is_cap(const TriMesh& mesh, std::size_t t) {
    return is_cut_look(mesh.material[std::size_t(mesh.triangle_material[t])]);
}

// How far a cap lies off the path where it is farthest, along x [m].
double off_path(const TriMesh& mesh, const std::vector<Vec3>& position, const BentPath& path,
                bool at_corners) {
    double worst = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        if (!is_cap(mesh, t)) continue;
        const auto& [a, b, c] = mesh.triangle[t];
        const Vec3 middle = (position[a] + position[b] + position[c]) / 3;
        for (const Vec3& p :
             {at_corners ? position[a] : middle, at_corners ? position[b] : middle}) {
            worst = std::max(worst, std::abs(p.x() - path.off(p.y(), p.z())));
        }
    }
    return worst;
}

}  // namespace

TEST_CASE("a cut along a path that bends gives closed halves that fit it") {
    const BentPath path = GENERATE(from_range(paths()));
    const bool is_coarse = GENERATE(false, true);
    INFO(path.name << (is_coarse ? ", a box of twelve triangles" : ""));
    Fixture f(is_coarse ? box_mesh({.5, .15, .15}, {1, 1, 1}, false) : bar());
    const double whole = signed_volume(f.mesh);
    const CutResult result = f.cut(sweep_of(path));
    CHECK(result.cuts == 1);
    CHECK(!result.has_folded);
    CHECK(result.open_parts == 0);
    check_sound(f.mesh, f.position);
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    REQUIRE(parts.size() == 2);
    double sum = 0, right = 0;
    for (const TriMesh& part : parts) {
        CHECK(test::is_closed(part));
        sum += signed_volume(part);
        double most = -1;
        for (const Corners& t : part.triangle) most = std::max(most, part.position[t[0]].x());
        if (most > 0.49) right = signed_volume(part);
    }
    CHECK(sum == Approx(whole).epsilon(1e-9));
    CHECK(right == Approx(volume_beyond(path)).epsilon(2e-3));
    const double a = f.matter.lattice.spacing;
    CHECK(off_path(f.mesh, f.position, path, true) < 0.004 * a);
    // Within a cap's triangles, whose edges are half a cell long; a corner is cut off by them.
    CHECK(off_path(f.mesh, f.position, path, false) < (path.name == "corner" ? 0.25 : 0.06) * a);
    // What a cap's texture is not, the rest's still is.
    double worst = 0;
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int uv = f.mesh.triangle_uv[t][k];
            CHECK((uv < 0) == is_cap(f.mesh, t));
            if (uv < 0) continue;
            const Vec3& p = f.mesh.position[f.mesh.triangle[t][k]];
            worst =
                std::max(worst, (f.mesh.uv[uv] - Vec2(p.x() + 2 * p.y(), p.z() - p.x())).norm());
        }
    }
    CHECK(worst < 1e-12);
}

TEST_CASE("halves of a cut along a path that bends follow the matter on their side of it") {
    const BentPath path = GENERATE(from_range(paths()));
    INFO(path.name);
    Fixture f(bar());
    f.cut(sweep_of(path));
    const std::vector<Vec3> before = f.position;
    sever_along(f.matter, path);
    const Pieces pieces = find_pieces(f.matter);
    REQUIRE(pieces.count == 2);
    const Vec3 away(0.7, 0.1, 0);
    for (std::size_t p = 0; p < f.matter.particle_count(); ++p) {
        const Vec3 at = f.matter.particle_reference.at(p);
        if (path.is_beyond(at)) f.matter.particle_position.add(p, away);
    }
    f.follow();
    double worst = 0;
    for (std::size_t v = 0; v < before.size(); ++v) {
        const double stayed = (f.position[v] - before[v]).norm();
        const double went = (f.position[v] - before[v] - away).norm();
        worst = std::max(worst, std::min(stayed, went));
    }
    CHECK(worst < 1e-12);
    CHECK(parts_of(f.mesh).size() == 2);
    for (const Corners& t : f.mesh.triangle) {
        for (int k = 0; k < 3; ++k) {
            CHECK((f.position[t[k]] - f.position[t[(k + 1) % 3]]).norm() < 0.3);
        }
    }
}

TEST_CASE("a cut along a path that bends is not to be seen before the matter is severed") {
    Fixture f(bar());
    f.bend();
    const std::vector<Vec3> before = f.position;
    const BentPath path = paths()[0];
    f.cut(sweep_of(path));
    check_sound(f.mesh, f.position);
    REQUIRE(parts_of(f.mesh).size() == 2);
    for (std::size_t v = 0; v < before.size(); ++v) CHECK(before[v] == f.position[v]);
    CHECK(off_path(f.mesh, f.position, path, true) < 0.004 * f.matter.lattice.spacing);
}

TEST_CASE("where a path that bends ends inside, the cut does") {
    const BentPath path = paths()[0];
    Sweep sweep = sweep_of(path);
    std::erase_if(sweep, [](const auto& t) { return t[0].y() + t[1].y() + t[2].y() > 0; });
    Fixture f(bar());
    const double whole = signed_volume(f.mesh);
    CHECK(f.cut(sweep).open_parts == 0);
    check_sound(f.mesh, f.position);
    CHECK(parts_of(f.mesh).size() == 1);
    CHECK(cap_triangles(f.mesh) > 0);
    CHECK(signed_volume(f.mesh) == Approx(whole).epsilon(1e-9));
    double high = -1;
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        for (const int v : f.mesh.triangle[t]) {
            if (is_cap(f.mesh, t)) high = std::max(high, f.position[v].y());
        }
    }
    CHECK(std::abs(high) < 0.5 * f.matter.lattice.spacing);
}

// Whose points within faces and edges lie anyhow.
TriMesh uneven_bar(std::mt19937& random) {
    TriMesh mesh = bar();
    const Vec3 half(.5, .15, .15), step(1 / 24.0, .3 / 9, .3 / 9);
    for (Vec3& p : mesh.position) {
        for (int k = 0; k < 3; ++k) {
            const double share = random() / 4294967296.0;
            if (std::abs(std::abs(p[k]) - half[k]) > 1e-9) p[k] += 0.7 * (share - 0.5) * step[k];
        }
    }
    return mesh;
}

TEST_CASE("a corner of a path closes the skin on both sides, however sharp") {
    // The seed of an uneven mesh; 0: an even one.
    const auto [slope, seed] =
        GENERATE(table<double, unsigned>({{2.0, 0}, {3.0, 0}, {4.4, 0}, {5.5, 1}, {5.5, 3}}));
    std::mt19937 random(seed);
    for (int n = 0; n < 24; ++n) {
        const double y0 = 0.01 + 0.0037 * (n - 12), deep = slope * 0.075 + 0.0011 * n;
        const BentPath path{"", [&](double y, double) { return slope * std::abs(y - y0) - deep; }};
        INFO(slope << " " << seed << " " << y0 << " " << deep);
        Fixture f(seed == 0 ? bar() : uneven_bar(random));
        const double whole = signed_volume(f.mesh);
        const CutResult result = f.cut(sweep_of(path, 0.23, 4));
        CHECK(!result.has_folded);
        CHECK(result.open_parts == 0);
        REQUIRE(test::is_closed(f.mesh));
        const std::vector<TriMesh> parts = parts_of(f.mesh);
        REQUIRE(parts.size() == 2);
        double least = 1, sum = 0;
        for (const TriMesh& part : parts) {
            least = std::min(least, signed_volume(part));
            sum += signed_volume(part);
        }
        CHECK(sum == Approx(whole).epsilon(1e-9));
        CHECK(least > 0);
    }
}

namespace {

// Of an edge that goes round an axis, which it then goes along from -reach to `to`.
struct RoundPath {
    Vec3 middle, axis;
    double radius = 0.107, waves = 0;  // [m]; share of the radius
    double from = -0.23, to = 0.23;

    Sweep sweep() const {
        constexpr int kAround = 240, kAlong = 24;
        const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
        const auto at = [&](int i, int j) -> Vec3 {
            const double turn = 2 * kPi * (i % kAround) / kAround;
            const double r = radius * (1 + waves * std::cos(5 * turn));
            return middle + r * (std::cos(turn) * u + std::sin(turn) * v) +
                   (from + (to - from) * j / kAlong) * axis;
        };
        Sweep all;
        for (int j = 0; j < kAlong; ++j) {
            for (int i = 0; i < kAround; ++i) {
                all.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                all.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            }
        }
        return all;
    }
    double area() const { return kPi * radius * radius * (1 + 0.5 * waves * waves); }
};

}  // namespace

TEST_CASE("an edge that goes all around cuts a plug out") {
    const bool hollow = GENERATE(false, true);
    const auto [middle, axis, waves] = GENERATE(table<Vec3, Vec3, double>({
        {Vec3(.0137, 0, 0), Vec3(0, 1, 0), 0},
        {Vec3(.0137, 0, 0), Vec3(0, -1, 0), 0.2},
        {Vec3(0, 0, 0), Vec3(0, 0, 1), 0.1},
        {Vec3(.02, .01, 0), Vec3(.1, 1, .15), 0.1},
    }));
    INFO(hollow << " " << axis.transpose() << " " << waves);
    Fixture f(bar(hollow));
    const double whole = signed_volume(f.mesh);
    RoundPath path{middle, axis.normalized()};
    path.waves = waves;
    const CutResult result = f.cut(path.sweep());
    CHECK(result.cuts == 1);
    CHECK(!result.has_folded);
    CHECK(result.open_parts == 0);
    check_sound(f.mesh, f.position);
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    CHECK(parts.size() == 2);
    double sum = 0, plugs = 0;
    for (const TriMesh& part : parts) {
        CHECK(test::is_closed(part));
        sum += signed_volume(part);
        double most = -1;
        for (const Corners& t : part.triangle) most = std::max(most, part.position[t[0]].x());
        if (most < 0.49) plugs += signed_volume(part);
    }
    CHECK(sum == Approx(whole).epsilon(1e-9));
    if (!hollow) {
        const double thick = 0.3 / path.axis.cwiseAbs().maxCoeff();
        CHECK(plugs == Approx(path.area() * thick).epsilon(3e-3));
    }
    double worst = 0;
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        for (const int v : f.mesh.triangle[t]) {
            if (!is_cap(f.mesh, t) || waves > 0) continue;
            const Vec3 way = f.position[v] - middle;
            worst = std::max(worst, std::abs(way.cross(path.axis).norm() - path.radius));
        }
    }
    CHECK(worst < 1e-4);
}

TEST_CASE("where an edge that goes all around stops inside, the plug stays joined there") {
    Fixture f(bar());
    const double whole = signed_volume(f.mesh);
    RoundPath path{Vec3(.0137, 0, 0), Vec3(0, -1, 0)};
    path.to = 0.0123;
    CHECK(f.cut(path.sweep()).open_parts == 0);
    check_sound(f.mesh, f.position);
    CHECK(parts_of(f.mesh).size() == 1);
    CHECK(cap_triangles(f.mesh) > 0);
    CHECK(signed_volume(f.mesh) == Approx(whole).epsilon(1e-9));
}

TEST_CASE("a plug's wall has triangles as its area has, however long it is") {
    const int cells = GENERATE(20, 60);
    const double half = 0.025 * cells;
    INFO(cells);
    Fixture f(box_mesh({half, .15, .15}, {cells, 9, 9}, false), cells);
    const double whole = signed_volume(f.mesh);
    RoundPath path{Vec3(0, 0, 0), Vec3(1, 0, 0)};
    path.from = -half - 0.06, path.to = half + 0.06;
    const CutResult result = f.cut(path.sweep());
    CHECK(result.open_parts == 0);
    check_sound(f.mesh, f.position);
    const std::vector<TriMesh> parts = parts_of(f.mesh);
    REQUIRE(parts.size() == 2);
    const double one = signed_volume(parts[0]), other = signed_volume(parts[1]);
    CHECK(one + other == Approx(whole).epsilon(1e-9));
    CHECK(std::min(one, other) == Approx(path.area() * 2 * half).epsilon(3e-3));
    // On both sides, of edges of half a cell.
    const double a = 0.5 * f.matter.lattice.spacing;
    const double even = 2 * 2 * kPi * path.radius * 2 * half / (std::sqrt(3) / 4 * a * a);
    CHECK(cap_triangles(f.mesh) < 3 * even);
    double longest = 0;
    for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
        for (int k = 0; k < 3 && is_cap(f.mesh, t); ++k) {
            const Corners& c = f.mesh.triangle[t];
            longest = std::max(longest, (f.position[c[k]] - f.position[c[(k + 1) % 3]]).norm());
        }
    }
    CHECK(longest < 2 * a);
}
