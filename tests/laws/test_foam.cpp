// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>

#include "laws/cell_forces.h"
#include "laws/dual.h"
#include "tests/catch.h"

using namespace swage;

namespace {

constexpr double kPoisson[] = {0.0, 0.1, 0.3, 0.45};

Columns<double> diagonal(double x, double y, double z) { return {{x, 0, 0}, {0, y, 0}, {0, 0, z}}; }
double* number(Columns<double>& f, int n) {
    Triple<double>* column[] = {&f.x, &f.y, &f.z};
    Triple<double>& c = *column[n / 3];
    double* own[] = {&c.x, &c.y, &c.z};
    return own[n % 3];
}
Columns<double> random_gradient(std::mt19937& random, double far) {
    std::uniform_real_distribution<double> by(-far, far);
    Columns<double> f = diagonal(1, 1, 1);
    for (int n = 0; n < 9; ++n) *number(f, n) += by(random);
    return f;
}
double volume_of(const Columns<double>& f) { return dot(f.x, cross(f.y, f.z)); }
double size_of(Columns<double> f) {
    double most = 0;
    for (int n = 0; n < 9; ++n) most = std::max(most, std::abs(*number(f, n)));
    return most;
}

}  // namespace

TEST_CASE("powers are those of the library, in lanes of any width the same bytes") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> log(-7, 7), exponent(-60, 2);
    for (int n = 0; n < 2000; ++n) {
        const double x = n == 0 ? 1 : std::exp(log(random)), e = exponent(random);
        const double got = power(x, e);
        CHECK(got == Approx(std::pow(x, e)).epsilon(1e-15 * (4 + std::abs(e * std::log(x)))));
        const auto in_lanes = [&]<int kWidth>() {
            typedef LanesOf<kWidth> V;
            V v;
            for (int l = 0; l < kWidth; ++l) v[l] = l == kWidth - 1 ? x : 0.5 + l;
            return power(v, e)[kWidth - 1];
        };
        CHECK(in_lanes.operator()<2>() == got);
        CHECK(in_lanes.operator()<4>() == got);
        CHECK(in_lanes.operator()<8>() == got);
    }
}

TEST_CASE("foam's stress is the slope of its energy, crushed and inside out as well") {
    std::mt19937 random(7);
    int inverted = 0, crushed = 0;
    for (const double nu : kPoisson) {
        const CellModuli law = cell_moduli(1, nu, 1);
        for (int n = 0; n < 200; ++n) {
            const Columns<double> f = random_gradient(random, n % 2 ? 0.15 : 1);
            const double j = volume_of(f);
            inverted += j<0, crushed += j> 0 && j < law.foam_least;
            // Where the straight line begins its slope has a corner.
            if (std::abs(j - law.foam_least) < 0.01) continue;
            Columns<double> stress = foam_stress(law, f);
            for (int at = 0; at < 9; ++at) {
                const auto energy = [&](double by) {
                    Columns<double> moved = f;
                    *number(moved, at) += by;
                    return foam_energy(law, moved);
                };
                const double h =
                    2e-3 * std::min(1.0, std::max(0.05, std::abs(j))) / (1 + law.foam_power);
                const double slope =
                    (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
                CHECK(std::abs(slope - *number(stress, at)) < 1e-8 * (1 + size_of(stress)));
            }
        }
    }
    CHECK(inverted > 50);
    CHECK(crushed > 20);
}

TEST_CASE("foam's tangent is the slope of its stress") {
    std::mt19937 random(11);
    for (const double nu : kPoisson) {
        const CellModuli law = cell_moduli(1, nu, 1);
        for (int n = 0; n < 40; ++n) {
            const Columns<double> f = random_gradient(random, 0.2),
                                  way = random_gradient(random, 1);
            const Columns<Dual<double>> both = {pair(f.x, way.x), pair(f.y, way.y),
                                                pair(f.z, way.z)};
            const Columns<Dual<double>> got = foam_stress(law, both);
            const double h = 1e-5;
            const auto at = [&](double by) {
                return foam_stress(
                    law, Columns<double>{f.x + by * way.x, f.y + by * way.y, f.z + by * way.z});
            };
            const Columns<double> more = at(h), less = at(-h);
            const double size =
                size_of({(0.5 / h) * (more.x - less.x), (0.5 / h) * (more.y - less.y),
                         (0.5 / h) * (more.z - less.z)});
            CHECK(std::abs(got.x.x.slope - (more.x.x - less.x.x) / (2 * h)) < 1e-6 * size);
            CHECK(std::abs(got.y.x.slope - (more.y.x - less.y.x) / (2 * h)) < 1e-6 * size);
            CHECK(std::abs(got.z.y.slope - (more.z.y - less.z.y) / (2 * h)) < 1e-6 * size);
        }
    }
}

TEST_CASE("foam pressed or pulled along one axis keeps its Poisson's ratio and bears its stress") {
    for (const double nu : kPoisson) {
        const CellModuli law = cell_moduli(1, nu, 1);
        for (const double s : {0.3, 0.5, 0.9, 1.2, 2.0}) {
            const double wide = std::pow(s, -nu);
            const Columns<double> p = foam_stress(law, diagonal(wide, wide, s));
            const double expected = law.shear * (s - std::pow(s, -1 - 2 * nu));
            CHECK(p.z.z == Approx(expected).epsilon(1e-12));
            CHECK(std::abs(p.x.x) < 1e-12);
            CHECK(std::abs(p.y.y) < 1e-12);
        }
        // Small: Young's modulus.
        const double e = 1e-6, thin = 1 - nu * e;
        CHECK(foam_stress(law, diagonal(thin, thin, 1 + e)).z.z == Approx(e).epsilon(1e-5));
    }
}

TEST_CASE("foam's shear stress is linear in the shear, and only hydrostatic stress beside it") {
    for (const double nu : kPoisson) {
        const CellModuli law = cell_moduli(1, nu, 1);
        for (const double g : {0.01, 0.5, 2.0}) {
            // Of volume one: Cauchy's stress is mu (F F^T - 1).
            const Columns<double> f = {{1, 0, 0}, {g, 1, 0}, {0, 0, 1}}, p = foam_stress(law, f);
            CHECK(p.y.x == Approx(law.shear * g));
            CHECK(std::abs(p.z.z) < 1e-14);
            CHECK(p.x.x + g * p.y.x == Approx(law.shear * g * g));
        }
    }
}

TEST_CASE("foam resists being crushed, more and more as it gets thinner, and turned inside out") {
    for (const double nu : kPoisson) {
        const CellModuli law = cell_moduli(1, nu, 1);
        double last = 0;
        for (double s : {0.9, 0.5, 0.2, 0.05, 0.01, 0.0, -0.5, -1.0, -2.0}) {
            const double push = -foam_stress(law, diagonal(1, 1, s)).z.z;
            CHECK(push > last);
            CHECK(std::isfinite(push));
            last = push;
        }
        // As its formula says until it is a thousand times as stiff.
        for (double j : {1.001 * law.foam_least, 0.999 * law.foam_least}) {
            CHECK(foam_pressure(law, j) ==
                  Approx(std::pow(j, -law.foam_power)).epsilon(1e-4 * law.foam_power));
        }
    }
}
