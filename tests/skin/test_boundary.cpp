// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/boundary.h"

#include <algorithm>
#include <random>
#include <tuple>

#include "geometry/edges.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/boundary.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

int euler_number(const TriMesh& mesh) {
    int edges = 0;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto) { ++edges; });
    return static_cast<int>(mesh.position.size()) - edges + static_cast<int>(mesh.triangle.size());
}

// Least cosine between a triangle and the neighbours that it should be smooth with.
double sharpest_cosine(const TriMesh& mesh, int material) {
    const auto normal = [&](int t) -> Vec3 {
        const Corners& c = mesh.triangle[t];
        return (mesh.position[c[1]] - mesh.position[c[0]])
            .cross(mesh.position[c[2]] - mesh.position[c[0]])
            .normalized();
    };
    double least = 1;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        if (uses.size() != 2 || mesh.triangle_material[uses[0].triangle] != material ||
            mesh.triangle_material[uses[1].triangle] != material) {
            return;
        }
        least = std::min(least, normal(uses[0].triangle).dot(normal(uses[1].triangle)));
    });
    return least;
}

Aggregate rod(int across) {
    const double a = 1.0 / across;
    return test::make_shape(
        [](const Vec3& p) { return std::max(std::hypot(p.y(), p.z()) - .5, std::abs(p.x()) - 2); },
        Vec3(-2, -.5, -.5), Vec3i(4 * across, across, across), a);
}

Aggregate torus() {
    return test::make_shape(
        [](const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - 1, p.z()) - .4; },
        Vec3(-1.42, -1.41, -.43), Vec3i(24, 24, 8), .12);
}

double cut_area(const TriMesh& mesh) {
    TriMesh cut = mesh;
    cut.triangle.clear();
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        if (mesh.triangle_material[t] == 1) cut.triangle.push_back(mesh.triangle[t]);
    }
    return surface_area(cut);
}

}  // namespace

TEST_CASE("the boundary of a block of whole cells is the block") {
    const Aggregate block = test::make_block(7, 4, 3, 0.1, Material{});
    const TriMesh mesh = test::boundary_now(block);
    CHECK(test::is_closed(mesh));
    CHECK(euler_number(mesh) == 2);
    CHECK(signed_volume(mesh) == Approx(.7 * .4 * .3).epsilon(1e-12));
    CHECK(surface_area(mesh) == Approx(2 * (.7 * .4 + .7 * .3 + .4 * .3)).epsilon(1e-12));
}

TEST_CASE("round shapes get round boundaries of their true volume") {
    const auto [across, volume_bar] =
        GENERATE(table<int, double>({{4, .01}, {8, .003}, {13, .003}}));
    const Aggregate matter = rod(across);
    const TriMesh mesh = test::boundary_now(matter);
    CHECK(test::is_closed(mesh));
    CHECK(euler_number(mesh) == 2);
    CHECK(signed_volume(mesh) == Approx(matter.volume()).epsilon(volume_bar));
    double worst = 0;
    for (const Vec3& p : mesh.position) {
        if (std::abs(p.x()) > 1.8) continue;  // away from the ends
        worst = std::max(worst, std::abs(std::hypot(p.y(), p.z()) - .5));
    }
    CHECK(worst < 0.06 / across);
}

TEST_CASE("a box that lies askew in its lattice keeps its sides flat and its edges sharp") {
    const double turn = GENERATE(.3, .5, .7), a = 1. / 7;
    const Quat pose(Eigen::AngleAxisd(turn, Vec3(2, 1, 3).normalized()));
    const Vec3 half(.9, .5, .6);
    const Aggregate matter = test::make_shape(
        [&](const Vec3& p) {
            const Vec3 q = (pose.conjugate() * p).cwiseAbs() - half;
            return q.maxCoeff() > 0 ? q.cwiseMax(0.).norm() : q.maxCoeff();
        },
        Vec3::Constant(-1.2), Vec3i::Constant(17), a);
    const TriMesh mesh = test::boundary_now(matter);
    CHECK(test::is_closed(mesh));
    CHECK(euler_number(mesh) == 2);
    double square = 0;
    for (const Vec3& p : mesh.position) {
        const Vec3 q = (pose.conjugate() * p).cwiseAbs() - half;
        square += std::pow(q.maxCoeff() / a, 2);
    }
    CHECK(std::sqrt(square / double(mesh.position.size())) < 0.01);
    for (int c = 0; c < 8; ++c) {
        const Vec3 sign(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
        double nearest = 1e9;
        for (const Vec3& p : mesh.position) {
            nearest = std::min(nearest, (pose * sign.cwiseProduct(half) - p).norm());
        }
        CHECK(nearest < 0.25 * a);
    }
    double all = 0, askew = 0;
    for (const Corners& c : mesh.triangle) {
        const Vec3 p = mesh.position[c[0]];
        const Vec3 area = (mesh.position[c[1]] - p).cross(mesh.position[c[2]] - p);
        all += area.norm();
        const bool along = (pose.conjugate() * area).cwiseAbs().maxCoeff() > .9 * area.norm();
        if (!along) askew += area.norm();
    }
    CHECK(askew < 0.005 * all);
}

TEST_CASE("handles are kept") {
    const TriMesh mesh = test::boundary_now(torus());
    CHECK(test::is_closed(mesh));
    CHECK(euler_number(mesh) == 0);
    CHECK(surface_components(mesh).count == 1);
    CHECK(signed_volume(mesh) == Approx(2 * kPi * kPi * .16).epsilon(.01));
    CHECK(sharpest_cosine(mesh, 0) > 0.7);
}

TEST_CASE("thin sheets keep both sides") {
    const double thickness = GENERATE(.3, .8, 1.3);
    const Aggregate sheet = test::make_shape(
        [&](const Vec3& p) {
            return std::max(
                {std::abs(p.x()) - 5.1, std::abs(p.y()) - 4.2, std::abs(p.z()) - thickness / 2});
        },
        Vec3(-6, -5, -.93), Vec3i(12, 10, 2), 1.0);
    const TriMesh mesh = test::boundary_now(sheet);
    CHECK(test::is_closed(mesh));
    CHECK(euler_number(mesh) == 2);
    CHECK(signed_volume(mesh) == Approx(sheet.volume()).epsilon(.02));
}

TEST_CASE("a severed body gets two closed surfaces with flat cut faces and all its volume") {
    const Vec3 normal = GENERATE(Vec3(1, 0, 0), Vec3(1, .5, 0), Vec3(1, .31, -.44), Vec3(1, 1, 1));
    const bool round = GENERATE(false, true);
    Aggregate matter = round ? rod(8) : test::make_block(32, 8, 8, .125, Material{});
    const double whole = matter.volume();
    const Vec3 n = normal.normalized(), point(.0371, .011, -.0083);
    test::sever_plane(matter, point, n);
    REQUIRE(find_pieces(matter).count == 2);
    TriMesh mesh = test::boundary_now(matter);
    CHECK(test::is_closed(mesh));
    const Components halves = surface_components(mesh);
    CHECK(halves.count == 2);
    CHECK(signed_volume(mesh) == Approx(whole).epsilon(.01));
    const double section = (round ? kPi / 4 : 1.) / n.x();
    CHECK(cut_area(mesh) == Approx(2 * section).epsilon(.04));
    CHECK(sharpest_cosine(mesh, 1) > 0.999);
    double off = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        if (mesh.triangle_material[t] != 1) continue;
        for (int v : mesh.triangle[t]) {
            off = std::max(off, std::abs(n.dot(mesh.position[v] - point)));
        }
    }
    CHECK(off < .6 * .125);
    int folded = 0;  // triangles of the outer surface that look inwards
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        if (mesh.triangle_material[t] != 0) continue;
        const Corners& c = mesh.triangle[t];
        const Vec3 p = mesh.position[c[0]];
        const Vec3 out = (mesh.position[c[1]] - p).cross(mesh.position[c[2]] - p);
        const Vec3 middle = (p + mesh.position[c[1]] + mesh.position[c[2]]) / 3;
        if (std::abs(middle.x()) > 1.7) continue;
        folded += out.dot(Vec3(0, middle.y(), middle.z())) < 0;
    }
    CHECK(folded == 0);

    SECTION("and each half moves with its own matter") {
        const TriMesh rest = mesh;
        const Quat turn(Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()));
        test::deform(matter, [&](const Vec3& p) -> Vec3 {
            return n.dot(p - point) >= 0 ? Vec3(turn * p + Vec3(3, 0, 0)) : p;
        });
        mesh = test::boundary_now(matter);
        REQUIRE(mesh.position.size() == rest.position.size());
        double worst = 0;
        for (std::size_t v = 0; v < rest.position.size(); ++v) {
            const double stays = (mesh.position[v] - rest.position[v]).norm();
            const Vec3 turned = turn * rest.position[v] + Vec3(3, 0, 0);
            worst = std::max(worst, std::min(stays, (mesh.position[v] - turned).norm()));
        }
        CHECK(worst < 1e-12);
        CHECK(signed_volume(mesh) == Approx(whole).epsilon(.01));
    }
}

TEST_CASE("a severed body that stands askew has all its volume") {
    const int across = GENERATE(3, 4);
    const Vec3 half(.6, .5, .7), normal = GENERATE(Vec3(1, .31, -.44), Vec3(.3, 1, .8));
    const Quat pose = Eigen::AngleAxisd(.5, Vec3::UnitX()) * Eigen::AngleAxisd(.6, Vec3::UnitY()) *
                      Eigen::AngleAxisd(.4, Vec3::UnitZ());
    CAPTURE(across, normal);
    Aggregate matter = test::make_shape(
        [&](const Vec3& p) {
            const Vec3 q = (pose.conjugate() * p).cwiseAbs() - half;
            return q.maxCoeff() > 0 ? q.cwiseMax(0.).norm() : q.maxCoeff();
        },
        Vec3::Constant(-1.2), Vec3i::Constant(int(std::ceil(2.4 * across))), 1. / across);
    test::sever_plane(matter, Vec3(.0371, .011, -.0083), normal.normalized());
    const TriMesh mesh = test::boundary_now(matter);
    CHECK(test::is_closed(mesh));
    CHECK(surface_components(mesh).count == 2);
    CHECK(signed_volume(mesh) == Approx(matter.volume()).epsilon(.03));
}

TEST_CASE(
    "where a blade passes close above the surface, what it cuts off elsewhere does not reach") {
    // A ball's cap is cut off; beside it the blade goes over a rod, through cells that hold nothing
    // there: their corners above it hang together with the cap.
    const double a = .125, above = GENERATE(.1, .3, .45), tilt = GENERATE(0., .04);
    Aggregate matter = test::make_shape(
        [](const Vec3& p) {
            const double rod = std::max(std::hypot(p.y(), p.z()) - .55, std::abs(p.x()) - 2);
            return std::min(rod, (p - Vec3(2, 0, 0)).norm() - .9);
        },
        Vec3(-2.1, -1, -1), Vec3i(41, 16, 16), a);
    const Vec3 normal = Vec3(tilt, 0, 1).normalized(), point(.5, 0, .55 + above * a);
    test::sever_plane(matter, point, normal);
    REQUIRE(find_pieces(matter).count == 2);
    test::deform(matter, [&](const Vec3& p) -> Vec3 {
        return normal.dot(p - point) > 0 ? Vec3(p + Vec3(0, 0, 10)) : p;
    });
    const TriMesh mesh = test::boundary_now(matter);
    CHECK(test::is_closed(mesh));
    CHECK(surface_components(mesh).count == 2);
    double least = 9;
    for (const Vec3& p : mesh.position) least = p.z() > 5 ? std::min(least, p.x()) : least;
    const double cap = 2 - std::sqrt(.81 - std::pow(.55 + above * a - 1.5 * tilt, 2));
    CHECK(least > cap - a);
}

TEST_CASE("every vertex goes with its own piece, wherever a cut of any shape runs", "[stress]") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    const double a = 1.0 / 4;
    for (int trial = 0; trial < 100; ++trial) {
        Aggregate body = rod(4);
        // A plane that is bent, as one is that a blade has cut through twisted matter.
        const Vec3 normal = Vec3(1, any(random), any(random)).normalized();
        const double bend = 3 * any(random), twist = 3 * any(random), at = 0.5 * any(random);
        std::vector<char> beyond(body.particle_count());
        for (std::size_t p = 0; p < beyond.size(); ++p) {
            const Vec3 x = body.particle_reference.at(p);
            beyond[p] = normal.dot(x) + bend * x.y() * x.y() + twist * x.y() * x.z() > at;
        }
        for (const Span& span : body.lattice.span) {
            for (int n = 0; n < span.count; ++n) {
                if (beyond[span.lower + n] != beyond[span.upper + n])
                    body.connection[span.direction].weight.set(span.lower + n, 0);
            }
        }
        for (std::size_t p = 0; p < beyond.size(); ++p) {
            if (beyond[p]) body.particle_position.x[p] += 100;
        }
        const TriMesh mesh = test::boundary_now(body);
        double longest = 0;
        for (const Corners& t : mesh.triangle) {
            for (int k = 0; k < 3; ++k) {
                longest =
                    std::max(longest, (mesh.position[t[k]] - mesh.position[t[(k + 1) % 3]]).norm());
            }
        }
        INFO(trial);
        CHECK(longest < 4 * a);
    }
}

TEST_CASE("a body half severed stays in one piece, with a slit") {
    Aggregate matter = test::make_block(16, 6, 6, .1, Material{});
    test::sever_plane(matter, {.03, 0, 0}, Vec3::UnitX(),
                      [](const Vec3& p) { return p.y() > .01; });
    const TriMesh mesh = test::boundary_now(matter);
    CHECK(surface_components(mesh).count == 1);
    CHECK(euler_number(mesh) == 2);
    CHECK(test::is_closed(mesh));
    CHECK(signed_volume(mesh) == Approx(matter.volume()).epsilon(1e-9));
    CHECK(cut_area(mesh) > 0);
}

TEST_CASE("rubble keeps its volume, each piece about its own particles") {
    const double share = GENERATE(1., .6, .3);  // of the connections that are gone
    const double a = .1;
    Aggregate matter = test::make_block(8, 5, 6, a, Material{});
    std::mt19937 random(7);
    std::uniform_real_distribution<double> draw(0, 1);
    for (const Span& span : matter.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            if (draw(random) > share) continue;
            matter.connection[span.direction].weight.set(span.lower + n, 0);
        }
    }
    const TriMesh rest = test::boundary_now(matter);
    int open = 0;  // slits may meet in an edge of four faces
    for_each_edge(edge_uses(rest.triangle, rest.position.size()), [&](auto uses) {
        int balance = 0;
        for (const auto& use : uses) balance += use.forward ? 1 : -1;
        open += balance != 0;
    });
    CHECK(open == 0);
    CHECK(signed_volume(rest) == Approx(matter.volume()).epsilon(share == 1 ? 1e-9 : .01));
    const Pieces pieces = find_pieces(matter);
    REQUIRE((share < 1 || pieces.count == static_cast<int>(matter.particle_count())));
    std::vector<Vec3> way(pieces.count);
    for (Vec3& w : way) w = 10 * Vec3(draw(random), draw(random), draw(random));
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        matter.particle_position.add(p, way[pieces.particle_piece[p]]);
    }
    const TriMesh scattered = test::boundary_now(matter);
    CHECK(signed_volume(scattered) == Approx(signed_volume(rest)).epsilon(1e-9));
    double longest = 0;
    for (const Corners& c : scattered.triangle) {
        for (int k = 0; k < 3; ++k) {
            const Vec3 edge = scattered.position[c[k]] - scattered.position[c[(k + 1) % 3]];
            longest = std::max(longest, edge.norm());
        }
    }
    CHECK(longest < 2 * a);
}

TEST_CASE("cells that only touch at an edge or a corner get separate vertices") {
    std::vector<Vec3i> cells = {{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {0, 2, 1}, {3, 1, 1}, {2, 2, 2}};
    std::sort(cells.begin(), cells.end(), [](const Vec3i& a, const Vec3i& b) {
        return std::tuple(a.z(), a.y(), a.x()) < std::tuple(b.z(), b.y(), b.x());
    });
    const Aggregate matter = test::make_matter(Vec3::Zero(), 1, Vec3i(4, 3, 3), cells,
                                               std::vector<float>(cells.size(), 1.f));
    const TriMesh mesh = test::boundary_now(matter);
    CHECK(test::is_closed(mesh));
    CHECK(surface_components(mesh).count == 6);
    CHECK(euler_number(mesh) == 12);
    // Apart, so that nothing joins them again: by that much less than 6.
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
        for (std::size_t w = 0; w < v; ++w) {
            CHECK((mesh.position[v] - mesh.position[w]).norm() > 0.01);
        }
    }
    CHECK(signed_volume(mesh) < 6);
    CHECK(signed_volume(mesh) == Approx(6).epsilon(0.01));
}

TEST_CASE("the boundary keeps its triangles while the body bends") {
    Aggregate matter = rod(4);
    const TriMesh rest = test::boundary_now(matter);
    test::deform(matter, [](const Vec3& p) -> Vec3 {
        return {p.x() + p.y() * p.z(), 1.5 * p.y() + 0.3 * p.x() * p.x(), p.z() - 0.4 * p.x()};
    });
    CHECK(test::boundary_now(matter).triangle == rest.triangle);
}

TEST_CASE("the boundary turns with the body") {
    Aggregate matter = torus();
    const TriMesh rest = test::boundary_now(matter);
    const Quat turn(Eigen::AngleAxisd(2.2, Vec3(1, -1, .3).normalized()));
    const auto map = [&](const Vec3& p) -> Vec3 { return turn * p + Vec3(-1, 4, 2); };
    test::deform(matter, map);
    const TriMesh moved = test::boundary_now(matter);
    double worst = 0;
    for (std::size_t v = 0; v < rest.position.size(); ++v) {
        worst = std::max(worst, (moved.position[v] - map(rest.position[v])).norm());
    }
    CHECK(worst < 1e-12 * 10);
}
