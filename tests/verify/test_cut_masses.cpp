// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of molded bodies weigh what their shape and density say, wherever the blade goes between
// the layers of particles.
#include "geometry/box_mesh.h"
#include "mold/mold.h"
#include "sim/weigh_pieces.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

// Of a closed surface what lies below the plane [m3]. A cap there adds nothing: it is told from a
// point on it.
double volume_below(const TriMesh& mesh, const Vec3& point, const Vec3& normal) {
    double sum = 0;
    for (const auto& corner : mesh.triangle) {
        std::vector<Vec3> kept;
        for (int c = 0; c < 3; ++c) {
            const Vec3 a = mesh.position[std::size_t(corner[c])] - point,
                       b = mesh.position[std::size_t(corner[(c + 1) % 3])] - point;
            const double from = normal.dot(a), to = normal.dot(b);
            if (from < 0) kept.push_back(a);
            if ((from < 0) != (to < 0)) kept.push_back(a + from / (from - to) * (b - a));
        }
        for (std::size_t n = 2; n < kept.size(); ++n) {
            sum += kept[0].dot(kept[n - 1].cross(kept[n])) / 6;
        }
    }
    return sum;
}

// The masses below the plane and above it.
std::array<double, 2> cut(Aggregate& m, const Vec3& point, const Vec3& normal) {
    const Vec3 u = 10 * normal.unitOrthogonal(), v = normal.cross(u);
    const auto events = crossed_connections(m, {{point - u - v, point + u - v, point + u + v},
                                                {point - u - v, point + u + v, point - u + v}});
    sever(m, events);
    weigh_pieces(m, events);
    const Pieces pieces = find_pieces(m);
    REQUIRE(pieces.count == 2);
    std::array<double, 2> mass{};
    std::vector<double> height(2, 0.0);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        height[pieces.particle_piece[p]] += normal.dot(m.particle_reference.at(p) - point);
    }
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        mass[height[pieces.particle_piece[p]] > 0] += m.particle_mass[p];
    }
    return mass;
}

}  // namespace

TEST_CASE("a piece of a molded body weighs what its shape and density say") {
    const int shape = GENERATE(0, 1, 2);
    const TriMesh mesh = shape == 0   ? test::sphere_mesh(0.4, 4)
                         : shape == 1 ? box_mesh(Vec3(-1.21, -0.4, -0.26), Vec3(1.21, 0.4, 0.26))
                                      : box_mesh(Vec3::Constant(-0.4), Vec3::Constant(0.4));
    const Vec3 normal = GENERATE(Vec3(0, 1, 0), Vec3(0.36, 1, 0), Vec3(-1, 1, 0.2)).normalized();
    const double off = GENERATE(-0.255, -0.105, -0.005, 0.005, 0.095, 0.2, 0.345);
    MoldSettings settings;
    settings.spacing = 0.1;
    Aggregate body = mold(mesh, Material{.density = 800}, settings);
    const double all = body.mass();
    const Vec3 at = off * normal;
    const double below = 800 * volume_below(mesh, at, normal);
    const auto [lower, upper] = cut(body, at, normal);
    const bool is_level = normal.y() == 1;
    // Of the ball caps of half a cell too.
    const double within = shape > 0 && is_level ? 0.005 : below < 0.98 * all ? 0.01 : 0.03;
    CAPTURE(shape, normal.transpose(), off, below / all);
    CHECK(lower == Approx(below).epsilon(within));
    CHECK(upper == Approx(all - below).epsilon(within));
    CHECK(body.mass() == Approx(all).epsilon(1e-12));
}

TEST_CASE("a plug weighs what its cylinder holds") {
    const double a = 0.1, radius = a * GENERATE(1.7, 2.5, 3.1);
    const Vec3 off = a * GENERATE(Vec3(0.01, 0, 0.02), Vec3(0.31, 0, 0.44));
    MoldSettings settings;
    settings.spacing = a;
    Aggregate body = mold(box_mesh(Vec3(-0.5, -0.3, -0.5), Vec3(0.5, 0.3, 0.5)),
                          Material{.density = 800}, settings);
    constexpr int kSides = 72;
    std::vector<std::array<Vec3, 3>> swept;
    for (int n = 0; n < kSides; ++n) {
        const auto at = [&](int side, double y) -> Vec3 {
            const double angle = 2 * kPi * (side % kSides) / kSides;
            return off + Vec3(radius * std::cos(angle), y, radius * std::sin(angle));
        };
        swept.push_back({at(n, -1), at(n + 1, -1), at(n + 1, 1)});
        swept.push_back({at(n, -1), at(n + 1, 1), at(n, 1)});
    }
    const double all = body.mass();
    const auto events = crossed_connections(body, swept);
    sever(body, events);
    weigh_pieces(body, events);
    const Pieces pieces = find_pieces(body);
    REQUIRE(pieces.count == 2);
    double plug = 0;
    for (std::size_t p = 0; p < body.particle_count(); ++p) {
        if (pieces.particle_piece[p] == 1) plug += body.particle_mass[p];
    }
    const double wanted = 800 * 0.6 * radius * radius * kSides / 2 * std::sin(2 * kPi / kSides);
    CAPTURE(radius, off.transpose());
    CHECK(plug == Approx(wanted).epsilon(0.01));
    CHECK(body.mass() == Approx(all).epsilon(1e-12));
}
