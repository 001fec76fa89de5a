// SPDX-License-Identifier: GPL-3.0-or-later
#include "laws/fracture.h"

#include <Eigen/SVD>
#include <array>
#include <bit>
#include <random>

#include "base/math.h"
#include "laws/strain_bound.h"
#include "tests/catch.h"

using namespace swage;

namespace {

constexpr double kModulus = 1e9, kStrength = 1e6, kToughness = 20, kSpacing = 1e-3;

Fracture law() { return fracture_law(kModulus, kStrength, kToughness, kSpacing); }

}  // namespace

TEST_CASE("a softening connection's tension is the gradient of what it stores and loses") {
    const Fracture f = law();
    for (double worst : {0.0, 0.5 * (f.peak + f.broken), 2 * f.broken}) {
        const auto whole = [&](double s) {
            return softened_energy(f, worst, s) + fracture_loss(f, std::max(worst, s));
        };
        for (double share : {-0.5, 0.1, 0.24, 0.6, 0.9, 1.3}) {
            const double s = share * f.broken, h = 1e-5 * f.broken;
            const double slope = (whole(s + h) - whole(s - h)) / (2 * h);
            CHECK(softened_strain(f, worst, s) == Approx(slope).margin(1e-7 * f.peak));
        }
    }
}

TEST_CASE("opening a lattice plane takes the toughness, in one go or with unloading between") {
    const Fracture f = law();
    // One edge and four diagonals over each square of the lattice.
    const double k = 0.4 * kModulus * kSpacing, edge = kSpacing * kSpacing;
    const auto over_area = [&](double loss) { return k * loss * (edge + 4 * 2 * edge) / edge; };
    CHECK(over_area(fracture_loss(f, 2 * f.broken)) == Approx(kToughness));
    double work = 0, worst = 0, before = 0, at = 0;
    const auto go = [&](double to) {
        constexpr int kSteps = 20000;
        const double from = at;
        for (int n = 1; n <= kSteps; ++n) {
            at = from + (to - from) * n / kSteps;
            const double now = softened_strain(f, worst, at);
            worst = std::max(worst, at);
            work += 0.5 * (before + now) * (to - from) / kSteps;
            before = now;
        }
    };
    for (double to : {0.5, 0.0, 0.7, 0.2, 1.1}) go(to * f.broken);
    CHECK(over_area(work) == Approx(kToughness).epsilon(1e-6));
}

TEST_CASE("a connection unloads to the origin, and the damage tells its largest strain") {
    const Fracture f = law();
    const double worst = 0.4 * f.broken;
    const double slope = softened_strain(f, worst, worst) / worst;
    CHECK(slope < 1);
    for (double share : {0.2, 0.7}) {
        CHECK(softened_strain(f, worst, share * worst) == Approx(slope * share * worst));
    }
    CHECK(worst_strain(f, 1 - kept_share(f, worst)) == Approx(worst));
    CHECK(worst_strain(f, 0) == Approx(f.peak));
    CHECK(worst_strain(f, 1) == Approx(f.broken));
}

TEST_CASE(
    "a spacing that cannot resolve the softening lowers the strength and keeps the toughness") {
    const double reach = fracture_reach(kModulus, kStrength, kToughness);
    CHECK(reach == Approx(0.02));
    CHECK(strength_at(kModulus, kStrength, kToughness, reach / 4) == Approx(kStrength));
    CHECK(strength_at(kModulus, kStrength, kToughness, reach) == Approx(kStrength / 2));
    const Fracture coarse = fracture_law(kModulus, kStrength, kToughness, reach);
    CHECK(coarse.broken > 2 * coarse.onset);
    CHECK(1.8 * kModulus * reach * coarse.peak * coarse.broken == Approx(kToughness));
}

TEST_CASE(
    "the diagonals of a face soften by their strain where both are pulled alike, not when "
    "pressed") {
    CHECK(face_strain(0.3, 0.3) == Approx(0.3));
    CHECK(face_strain(-0.3, -0.3) == 0);
    CHECK(face_strain(0, -0.3) == 0);
    CHECK(face_strain(0.2, -0.1) == face_strain(-0.1, 0.2));
    CHECK(face_strain(0.2, -0.2 - 1e-9) == Approx(face_strain(0.2, -0.2 + 1e-9)));
    CHECK(face_strain(0.2, 0) > 0.2);
}

TEST_CASE("sliding along a lattice plane takes the toughness as opening it does") {
    const Fracture f = law();
    const double k = 0.4 * kModulus * kSpacing;
    // Over each square of the plane two diagonals are pulled and pressed alike, the others turn.
    double work = 0, before = 0;
    constexpr int kSteps = 20000;
    const double most = 2 * f.broken;
    for (int n = 1; n <= kSteps; ++n) {
        const double slid = most * n / kSteps, by = face_strain(slid, -slid);
        const double now = kept_share(f, by) * slid;
        work += 0.5 * (before + now) * most / kSteps;
        before = now;
    }
    CHECK(2 * 2 * k * work == Approx(kToughness).epsilon(1e-6));
    // Pressed, only by what one of the two is still pulled.
    CHECK(face_strain(0.2, -0.3) == Approx(face_strain(0.2, -0.2)));
    CHECK(face_strain(-0.1, -0.3) == 0);
}

TEST_CASE("a cell whose strain measure is small has no strain that reaches the bound") {
    std::mt19937 engine(7);
    std::normal_distribution<double> draw;
    const double a = 0.3, gram = 1 / (16 * a * a);
    double closest = 0, closest_there = 0;
    for (int round = 0; round < 20000; ++round) {
        // Stretched, sheared and bent to different shares, turned somehow.
        Mat3 f = Mat3::Identity();
        const double stretch = 0.05 * std::abs(draw(engine)), bend = 0.05 * std::abs(draw(engine));
        for (int n = 0; n < 9; ++n) f(n / 3, n % 3) += stretch * draw(engine);
        f = Quat(draw(engine), draw(engine), draw(engine), draw(engine)).normalized() * f;
        std::array<Vec3, 8> x;
        double at[3][8];
        for (int c = 0; c < 8; ++c) {
            x[c] = a * (f * Vec3(c & 1, c >> 1 & 1, c >> 2));
            for (int i = 0; i < 3; ++i) x[c][i] += (round % 2) * bend * a * draw(engine);
            for (int i = 0; i < 3; ++i) at[i][c] = x[c][i];
        }
        const CornerSums<double> s = sum_corners(at);
        const double measure = strain_measure(s, gram, kInMiddle);
        const Triple<double> off = {(engine() % 3) - 1.0, (engine() % 3) - 1.0,
                                    (engine() % 3) - 1.0};
        const Columns<double> there = centroid_gradient(s, off, a);
        Mat3 local;
        local << there.x.x, there.y.x, there.z.x, there.x.y, there.y.y, there.z.y, there.x.z,
            there.y.z, there.z.z;
        const double most_there = local.jacobiSvd().singularValues()[0] - 1;
        if (most_there > 0) {
            const double bound = strain_measure(s, gram, kAnywhere);
            CHECK(bound >= strain_measure_at(most_there));
            closest_there = std::max(closest_there, strain_measure_at(most_there) / bound);
        }
        Mat3 mean;
        mean << s.x.x, s.y.x, s.z.x, s.x.y, s.y.y, s.z.y, s.x.z, s.y.z, s.z.z;
        mean /= 4 * a;
        double most = mean.jacobiSvd().singularValues()[0] - 1;
        for (int low = 0; low < 8; ++low) {
            for (int high = low + 1; high < 8; ++high) {
                const int axes = std::popcount(unsigned(low ^ high));
                if (axes == 3) continue;
                most = std::max(most, (x[high] - x[low]).norm() / (a * std::sqrt(axes)) - 1);
            }
        }
        if (most <= 0) continue;
        CHECK(measure >= strain_measure_at(most));
        closest = std::max(closest, strain_measure_at(most) / measure);
    }
    CHECK(closest > 0.6);
    CHECK(closest_there > 0.6);
}
