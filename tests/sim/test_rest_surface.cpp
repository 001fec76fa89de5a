// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "sim/rest_surface.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

struct Error {
    double worst = 0, turn = 0;
    int places = 0;
};

// Against the exact distance, at places inside and less than `deep` spacings from the surface.
Error error_of(const Aggregate& m, const test::Distance& exact, double deep) {
    const RestSurface surface(m);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(0, 1);
    const double a = m.lattice.spacing;
    Error error;
    for (CellId cell : surface.skin()) {
        for (int n = 0; n < 12; ++n) {
            const Vec3 place(any(random), any(random), any(random));
            const Vec3 x =
                m.lattice.origin + a * (m.lattice.cell_site(cell).cast<double>() + place);
            const double wanted = exact(x) / a;
            if (wanted > 0 || wanted < -deep) continue;
            const RestSurface::Depth d = surface.at(cell, place);
            const double size = d.gradient.norm();
            const Vec3 normal = gradient_of(exact, x, 1e-6 * a);
            error.worst = std::max(error.worst, std::abs(d.distance / size - wanted));
            error.turn = std::max(error.turn, (d.gradient / size - normal).norm());
            ++error.places;
        }
    }
    return error;
}

}  // namespace

TEST_CASE("depth below a plane that runs obliquely through the cells is exact") {
    const Vec3 normal = Vec3(1, 3, -0.6).normalized();
    const test::Distance half = [&](const Vec3& x) { return normal.dot(x); };
    const Aggregate m = make_shape(half, Vec3(-0.6, -0.6, -0.6), Vec3i(12, 12, 12), 0.1);
    const test::Distance inner = [&](const Vec3& x) {
        return x.cwiseAbs().maxCoeff() < 0.35 ? half(x) : 1;
    };
    const Error error = error_of(m, inner, 0.7);
    CHECK(error.places > 300);
    CHECK(error.worst < 1e-5);
    CHECK(error.turn < 1e-4);
}

TEST_CASE("depth below a sphere is right to a few hundredths of a spacing") {
    const test::Distance ball = [](const Vec3& x) { return x.norm() - 0.52; };
    const Aggregate m = make_shape(ball, Vec3(-0.6, -0.6, -0.6), Vec3i(12, 12, 12), 0.1);
    const Error error = error_of(m, ball, 0.5);
    INFO("worst " << error.worst << ", turn " << error.turn);
    CHECK(error.places > 1000);
    CHECK(error.worst < 0.04);
    CHECK(error.turn < 0.1);
}

TEST_CASE("a box keeps its edges, and a plate one cell thick its two sides") {
    const Material any;
    for (const Vec3i& count : {Vec3i(6, 6, 6), Vec3i(8, 1, 8)}) {
        const Aggregate m = make_block(count.x(), count.y(), count.z(), 0.1, any);
        const Vec3 half = 0.05 * count.cast<double>();
        const RestSurface surface(m);
        std::mt19937 random(1);
        std::uniform_real_distribution<double> in(-0.97, 0.97);
        for (int n = 0; n < 4000; ++n) {
            const Vec3 x = half.cwiseProduct(Vec3(in(random), in(random), in(random)));
            const Vec3 left = half - x.cwiseAbs();
            const double wanted = -left.minCoeff() / 0.1;
            if (wanted < -0.4) continue;
            const Vec3 g = (x - m.lattice.origin) / 0.1;
            const Vec3i site = g.array().floor().cast<int>();
            const CellId cell = m.lattice.cell_at(site);
            const RestSurface::Depth d = surface.at(cell, g - site.cast<double>());
            REQUIRE(d.distance / d.gradient.norm() == Approx(wanted).margin(0.05));
        }
    }
}

namespace {

// The depth at a place of the lattice [cells], where a cell of the rim holds it.
bool depth_at(const Aggregate& m, const RestSurface& surface, const Vec3& g,
              RestSurface::Depth& depth) {
    const Vec3i site = g.array().floor().cast<int>();
    const CellId cell = m.lattice.cell_at(site);
    if (cell < 0 || !surface.is_rim(cell)) return false;
    depth = surface.at(cell, g - site.cast<double>());
    return true;
}

}  // namespace

TEST_CASE("depth is continuous along any line through edges, corners and cells") {
    const test::Distance ball = [](const Vec3& x) { return x.norm() - 0.32; };
    const Mat3 turn = Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const test::Distance box = [&](const Vec3& x) {
        return ((turn * x).cwiseAbs() - Vec3(0.37, 0.3, 0.25)).maxCoeff();
    };
    std::mt19937 random(2);
    std::uniform_real_distribution<double> any(-1, 1);
    for (const Aggregate& m : {make_block(4, 3, 3, 0.1, {}),
                               make_shape(box, Vec3(-0.6, -0.6, -0.6), Vec3i(12, 12, 12), 0.1),
                               make_shape(ball, Vec3(-0.4, -0.4, -0.4), Vec3i(8, 8, 8), 0.1)}) {
        const RestSurface surface(m);
        double jump = 0, slope = 0;
        int crossed = 0, odd = 0;
        for (int line = 0; line < 1000; ++line) {
            const std::size_t p = random() % m.surface.size();
            const Vec3 start = (m.surface_reference(p) - m.lattice.origin) / 0.1;
            const Vec3 way = Vec3(any(random), any(random), any(random));
            // Both sides of every plane between samples.
            for (int axis = 0; axis < 3; ++axis) {
                for (int n = -4; n <= 4; ++n) {
                    const double plane = 0.25 * (std::floor(4 * start[axis]) + n),
                                 t = (plane - start[axis]) / way[axis];
                    RestSurface::Depth before, after;
                    if (std::abs(t) > 1 ||
                        !depth_at(m, surface, start + (t - 1e-9) * way, before) ||
                        !depth_at(m, surface, start + (t + 1e-9) * way, after)) {
                        continue;
                    }
                    jump = std::max(jump, std::abs(after.distance - before.distance));
                    slope = std::max(slope, after.gradient.norm());
                    ++crossed;
                }
            }
            // And within: its slope is its slope.
            for (int n = 0; n < 20; ++n) {
                const Vec3 g = start + any(random) * way;
                RestSurface::Depth low, high;
                const Vec3 step = 1e-7 * way;
                if (!depth_at(m, surface, g, low) || !depth_at(m, surface, g + step, high))
                    continue;
                const double rise = high.distance - low.distance;
                odd += std::abs(rise - 0.5 * (low.gradient + high.gradient).dot(step)) > 1e-9;
            }
        }
        INFO("jump " << jump << ", slope " << slope);
        CHECK(slope < 3);
        CHECK(jump < 4e-9 * slope);
        CHECK(crossed > 2000);
        CHECK(odd == 0);
    }
}

TEST_CASE("nothing is deeper than a sliver where the cells of parts thinner than these end") {
    for (const double thick : {0.3, 0.6, 1.0}) {
        // A horn on a ball: a cone that leans, as thick at its foot as so many cells.
        const Vec3 axis = Vec3(0.3, 1, 0.2).normalized();
        const test::Distance horn = [&](const Vec3& x) {
            const double along = axis.dot(x), across = (x - along * axis).norm();
            const double cone = std::max(across - 0.05 * thick * (1 - along / 0.5), -along);
            return std::min(x.norm() - 0.17, cone);
        };
        const Aggregate m = make_shape(horn, Vec3(-0.3, -0.3, -0.3), Vec3i(9, 9, 9), 0.1);
        const RestSurface surface(m);
        double deepest = 0, at_once = 0;
        int slopes = 0, creases = 0;
        for (CellId cell : surface.skin()) {
            const Vec3i site = m.lattice.cell_site(cell);
            for (int face = 0; face < 6; ++face) {
                const int axis_of = face >> 1, side = face & 1;
                const Vec3i next = site + (side ? 1 : -1) * Vec3i(Vec3i::Unit(axis_of));
                if (m.lattice.cell_at(next) >= 0) continue;
                for (int n = 0; n < 25; ++n) {
                    Vec3 place;
                    place[axis_of] = side;
                    place[(axis_of + 1) % 3] = 0.11 + 0.19 * (n % 5);
                    place[(axis_of + 2) % 3] = 0.15 + 0.17 * (n / 5);
                    deepest = std::min(deepest, surface.at(cell, place).distance);
                    Vec3 beyond = place;
                    beyond[axis_of] = side ? 1 + kSliver : -kSliver;
                    at_once = std::min(at_once, surface.at_sliver(cell, beyond).distance);
                    beyond[axis_of] = side ? 1 + 0.1 : -0.1;
                    const RestSurface::Depth d = surface.at_sliver(cell, beyond);
                    for (int axis = 0; axis < 3 && d.distance != 0; ++axis) {
                        const Vec3 step = 1e-6 * Vec3::Unit(axis);
                        const double slope = (surface.at_sliver(cell, beyond + step).distance -
                                              surface.at_sliver(cell, beyond - step).distance) /
                                             2e-6;
                        // But on creases.
                        if (std::abs(slope - d.gradient[axis]) > 1e-3) ++creases;
                        ++slopes;
                    }
                }
            }
        }
        INFO("as thick as " << thick << " cells: " << deepest);
        CHECK(deepest > -0.21);
        CHECK(at_once > -1e-9);
        INFO(creases << " of " << slopes << " slopes");
        CHECK(slopes > 1000);
        CHECK(creases < 0.1 * slopes);
    }
}

TEST_CASE("bodies that are molded alike share one, wherever they are, and no others do") {
    const Aggregate block = make_block(3, 4, 5, 0.1, Material{});
    const auto shared = [&](const auto& change) {
        Aggregate other = block;
        change(other);
        return RestSurface::is_shared(block, other) && RestSurface::is_shared(other, block);
    };
    CHECK(shared([](Aggregate& m) {
        for (double& y : m.particle_position.y) y += 0.7;
        m.material.young_modulus *= 2;
    }));
    CHECK_FALSE(shared([](Aggregate& m) { m.lattice.spacing *= 1.0001; }));
    CHECK_FALSE(shared([](Aggregate& m) { m.lattice.origin.x() += 1e-3; }));
    CHECK_FALSE(shared([](Aggregate& m) {
        m.surface.move(7, m.surface.place(7) + Vec3(1e-3, 0, 0), m.surface.area(7));
    }));
    CHECK_FALSE(RestSurface::is_shared(block, make_block(4, 3, 5, 0.1, Material{})));
}
