// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "laws/cell_foam.h"
#include "laws/volume_guard.h"
#include "tests/catch.h"

using namespace swage;

namespace {

constexpr double kStep = 1e-6;

std::vector<GuardModuli> all_moduli() {
    std::vector<GuardModuli> all;
    for (double nu : {0.0, 0.25, 0.45}) {
        for (bool fades : {true, false}) {
            all.push_back({1, 1 / (2 * (1 + nu)), 1 / (3 * (1 - 2 * nu)), fades});
        }
        if (nu < 0.4) {  // foam
            all.push_back(all.back());
            all.back().volume = cell_moduli(1, nu, 1).foam_least;
        }
    }
    return all;
}

std::vector<Mat3> random_gradients(int count) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0, 0.7);
    std::vector<Mat3> all(count);
    for (Mat3& f : all) {
        for (int i = 0; i < 9; ++i) f.data()[i] = normal(random);
    }
    return all;
}

template <typename Energy>
Mat3 slope_of(const Mat3& at, const Energy& energy) {
    Mat3 slope;
    for (int i = 0; i < 9; ++i) {
        Mat3 way = Mat3::Zero();
        way.data()[i] = kStep;
        slope.data()[i] = (energy(at + way) - energy(at - way)) / (2 * kStep);
    }
    return slope;
}

// What a cell of each mechanics has of its own, by its principal stretches.
double cell_energy(const GuardModuli& law, const Mat3& f) {
    const Vec3 x = Eigen::JacobiSVD<Mat3>(f).singularValues();
    const Vec3 e = x.unaryExpr([](double s) { return cell_law_strain(s).value; });
    const double size = cell_law_strain(std::abs(f.determinant())).value;
    return law.shear * (e.array() - e.mean()).square().sum() + 0.5 * law.bulk * size * size;
}
double neo_hookean_energy(const GuardModuli& law, const Mat3& f) {
    const double grown = f.determinant() - 1, lame = law.bulk - 2 * law.shear / 3;
    return 0.5 * law.shear * (f.squaredNorm() - 3) - law.shear * grown +
           0.5 * (lame + law.shear) * grown * grown;
}
double storakers_energy(const GuardModuli& law, const Mat3& f) {
    const double nu = (3 * law.bulk - 2 * law.shear) / (2 * (3 * law.bulk + law.shear));
    const CellModuli own = cell_moduli(1, std::abs(nu) < 1e-12 ? 0 : nu, 1);
    return own.shear * (0.5 * (f.squaredNorm() - 3) + foam_volume_energy(own, f.determinant()));
}
double springs_energy(const GuardModuli& law, const Mat3& f) {
    double sum = 0;
    for (int n = 14; n < 27; ++n) {
        const Vec3 way(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        if (way.squaredNorm() > 2.5) continue;
        const double longer = (f * way).norm() - way.norm();
        sum += 0.5 * law.shear * longer * longer;
    }
    return sum;
}

}  // namespace

TEST_CASE("the volume guard's stress is the slope of its energy, inside out and not") {
    int inverted = 0, crushed = 0;
    for (const GuardModuli& law : all_moduli()) {
        for (const Mat3& f : random_gradients(200)) {
            const GuardedCell guard = guard_cell(law, f);
            const double j = f.determinant();
            inverted += j < 0;
            crushed += j > 0 && j < law.volume;
            const Mat3 slope =
                slope_of(f, [&](const Mat3& at) { return guard_cell(law, at).energy; });
            CHECK((guard.stress - slope).norm() < 1e-6 * (1 + slope.norm()));
            const Mat3 fades =
                slope_of(f, [&](const Mat3& at) { return guard_cell(law, at).share; });
            CHECK((guard.share_slope - fades).norm() < 1e-6 * (1 + fades.norm()));
        }
    }
    CHECK(inverted > 300);
    CHECK(crushed > 200);
}

TEST_CASE("the volume guard leaves alone what has its volume, and begins smoothly") {
    for (const GuardModuli& law : all_moduli()) {
        const Mat3 half = std::cbrt(law.volume) * Mat3::Identity();
        CHECK(guard_cell(law, 1.0001 * half).stress.isZero(0));
        CHECK(guard_cell(law, 1.0001 * half).energy == 0);
        // The less it has room for, the steeper it is.
        const double steep = std::pow(kGuardedVolume / law.volume, 2);
        CHECK(guard_cell(law, 0.9999 * half).stress.norm() < 1e-2 * steep);
        // Through zero, by one stretch.
        const Mat3 flat = Vec3(1.1, 0.8, 0).asDiagonal(), little = Vec3(0, 0, 1e-9).asDiagonal();
        const GuardedCell above = guard_cell(law, flat + little);
        const GuardedCell below = guard_cell(law, flat - little);
        CHECK(above.energy == Approx(below.energy).epsilon(1e-6));
        CHECK((above.stress - below.stress).norm() < 1e-6 * steep);
    }
}

TEST_CASE("crushed matter of every law goes down to its own shape from wherever it is") {
    using Energy = double (*)(const GuardModuli&, const Mat3&);
    const auto find_rest = [](const GuardModuli& law, Energy own, Mat3 f) {
        const auto energy = [&](const Mat3& at) {
            const GuardedCell guard = guard_cell(law, at);
            const double left = law.fades ? 1 - guard.share : 1;
            return left * own(law, at) + guard.energy;
        };
        double now = energy(f), length = 0.1 / law.bulk;
        for (int n = 0; n < 4000; ++n) {
            const Mat3 slope = slope_of(f, energy);
            if (slope.norm() < 1e-5) break;
            double next = energy(f - length * slope);
            while (!(next < now) && length > 1e-9) {
                length *= 0.5;
                next = energy(f - length * slope);
            }
            f -= length * slope;
            now = next;
            length *= 1.3;
        }
        return f;
    };
    for (const GuardModuli& law : all_moduli()) {
        std::vector<Mat3> start = random_gradients(12);
        start.push_back(Vec3(-1, 1, 1.001).asDiagonal());
        start.push_back(Vec3(-0.3, 0.5, 0.4).asDiagonal());
        start.push_back(Vec3(0.01, 0.01, 0.0101).asDiagonal());
        for (const Mat3& f : start) {
            std::vector<Energy> laws = {neo_hookean_energy};
            if (law.fades) laws = {cell_energy};
            if (law.volume < kGuardedVolume) laws = {storakers_energy};
            if (!law.fades && law.bulk < 0.7 && law.bulk > 0.5) laws.push_back(springs_energy);
            for (const Energy own : laws) {
                const Mat3 rest = find_rest(law, own, f);
                INFO("law " << (own == cell_energy          ? "cells"
                                : own == neo_hookean_energy ? "rubber"
                                : own == storakers_energy   ? "foam"
                                                            : "springs")
                            << " bulk " << law.bulk << " from\n"
                            << f << "\nto\n"
                            << rest);
                CHECK(rest.determinant() > 0.98);
                CHECK((rest.transpose() * rest - Mat3::Identity()).norm() < 0.03);
            }
        }
    }
}
