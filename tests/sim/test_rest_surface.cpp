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
    const RestSurface surface(m.lattice, m.surface);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(0, 1);
    const double a = m.lattice.spacing;
    Error error;
    for (CellId cell : surface.skin()) {
        for (int n = 0; n < 8; ++n) {
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
        const RestSurface surface(m.lattice, m.surface);
        std::mt19937 random(1);
        std::uniform_real_distribution<double> in(-0.97, 0.97);
        for (int n = 0; n < 4000; ++n) {
            const Vec3 x = half.cwiseProduct(Vec3(in(random), in(random), in(random)));
            const Vec3 left = half - x.cwiseAbs();
            const double wanted = -left.minCoeff() / 0.1;
            if (wanted < -0.4) continue;
            const Vec3 g = (x - m.lattice.origin) / 0.1;
            const Vec3i site = g.array().floor().cast<int>();
            const CellId cell = m.lattice.cell_at(site.x(), site.y(), site.z());
            const RestSurface::Depth d = surface.at(cell, g - site.cast<double>());
            REQUIRE(d.distance / d.gradient.norm() == Approx(wanted).margin(0.05));
        }
    }
}
