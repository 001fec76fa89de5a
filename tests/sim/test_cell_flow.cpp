// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "base/parallel.h"
#include "sim/cell_flow.h"
#include "sim/vector_clones.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

const Material kMetal{.young_modulus = 1e6, .yield_stress = 1e3};  // yields at 0.1 % strain

void strain_uniformly(Aggregate& m, const Mat3& gradient) {
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, gradient * m.particle_reference.at(p));
    }
}

// Cauchy stress of a uniformly strained block from the forces on its particles (virial).
Mat3 stress_of(const Aggregate& m, CellFlow& flow) {
    Vec3Array f;
    LatticeSweep(m).forces(m, &flow.rest_strains(m), f);
    Mat3 sum = Mat3::Zero();
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        sum -= f.at(p) * m.particle_position.at(p).transpose();
    }
    return sum / m.volume();
}

double von_mises(const Mat3& stress) {
    const Mat3 s = stress - stress.trace() / 3 * Mat3::Identity();
    return std::sqrt(1.5 * s.squaredNorm());
}

}  // namespace

TEST_CASE("a lattice yields at sigma_y after von Mises in tension, in shear and along diagonals") {
    Aggregate m = make_block(3, 3, 3, 0.1, kMetal);
    const double e = 0.002;
    Mat3 tension = Mat3::Identity(), shear = Mat3::Identity(), diagonal = Mat3::Identity();
    tension.diagonal() += Vec3(e, -e / 4, -e / 4);
    shear(0, 1) = shear(1, 0) = e;
    diagonal(0, 1) = diagonal(1, 0) = diagonal(1, 2) = diagonal(2, 1) = e;
    for (const Mat3& gradient : {tension, shear, diagonal}) {
        strain_uniformly(m, gradient);
        CellFlow flow(m);
        CHECK(von_mises(stress_of(m, flow)) == Approx(kMetal.yield_stress).epsilon(0.01));
    }
    Mat3 below = Mat3::Identity();
    below.diagonal() += 0.4 * Vec3(e, -e / 4, -e / 4);
    strain_uniformly(m, below);
    CellFlow flow(m);
    CHECK(stress_of(m, flow)(0, 0) == Approx(0.4 * e * kMetal.young_modulus).epsilon(0.01));
}

TEST_CASE("pressure never yields") {
    Aggregate m = make_block(2, 2, 2, 0.1, kMetal);
    strain_uniformly(m, 0.8 * Mat3::Identity());
    CellFlow flow(m);
    CHECK(flow.commit(m) == 0);
    CHECK(m.cell_plastic[0].empty());
}

TEST_CASE("flow is remembered only when committed, keeps the volume and leaves a set") {
    Aggregate m = make_block(2, 1, 1, 0.1, kMetal);
    const double stretch = 1.05;
    Mat3 gradient = Mat3::Identity();
    gradient.diagonal() = Vec3(stretch, 1 / std::sqrt(stretch), 1 / std::sqrt(stretch));
    strain_uniformly(m, gradient);
    CellFlow flow(m);
    const auto before = state_hash(m);
    flow.rest_strains(m);
    CHECK(state_hash(m) == before);
    const double lost = flow.commit(m);
    // Work of the yield stress along the plastic strain.
    CHECK(lost == Approx(m.volume() * 1e3 * (std::log(stretch) - 0.00083)).epsilon(0.05));
    CHECK(flow.commit(m) == Approx(0).margin(1e-5 * lost));
    // Unloaded to the set, hardly anything is left of the stress, and the volume is the old one.
    const double set = m.connection[0].plastic[0];
    CHECK(set == Approx(stretch - 1 - 0.00083).epsilon(0.01));
    gradient.diagonal() =
        Vec3(1 + set, 1 + m.connection[1].plastic[0], 1 + m.connection[2].plastic[0]);
    CHECK(gradient.determinant() == Approx(1).epsilon(1e-5));
    strain_uniformly(m, gradient);
    CHECK(stress_of(m, flow).norm() < 0.05 * kMetal.yield_stress);
}

TEST_CASE("hardening raises the stress with the plastic strain") {
    Material metal = kMetal;
    metal.hardening = 0.02 * metal.young_modulus;
    Aggregate m = make_block(2, 2, 2, 0.1, metal);
    CellFlow flow(m);
    for (double e : {0.005, 0.01, 0.02}) {
        Mat3 gradient = Mat3::Identity();
        gradient.diagonal() = Vec3(1 + e, 1 / std::sqrt(1 + e), 1 / std::sqrt(1 + e));
        strain_uniformly(m, gradient);
        flow.commit(m);
        const double expected = metal.yield_stress + metal.hardening * (std::log(1 + e) - 0.001);
        CHECK(von_mises(stress_of(m, flow)) == Approx(expected).epsilon(0.03));
    }
}

TEST_CASE("springs flow along a flow curve, in one step as in many") {
    Material metal = kMetal;
    metal.flow_along({{0, 1e3}, {0.004, 1.3e3}, {0.01, 1.3e3}, {0.015, 1.6e3}, {0.1, 2e3}});
    const auto on_curve = [&](double strain) {
        std::size_t n = 1;
        while (metal.flow_curve[n].strain < strain) ++n;
        const auto& [from, low] = metal.flow_curve[n - 1];
        const auto& [to, high] = metal.flow_curve[n];
        return low + (high - low) * (strain - from) / (to - from);
    };
    constexpr double kStrain = 0.02;
    double last[2], gone[2];
    for (int steps : {1, 50}) {
        Aggregate m = make_block(2, 2, 2, 0.1, metal);
        CellFlow flow(m);
        for (int n = 1; n <= steps; ++n) {
            const double e = kStrain * n / steps;
            Mat3 gradient = Mat3::Identity();
            gradient.diagonal() = Vec3(1 + e, 1 / std::sqrt(1 + e), 1 / std::sqrt(1 + e));
            strain_uniformly(m, gradient);
            flow.commit(m);
        }
        last[steps > 1] = von_mises(stress_of(m, flow));
        gone[steps > 1] = m.cell_history.hardening()[0];
        CHECK(last[steps > 1] == Approx(on_curve(gone[steps > 1])).epsilon(0.03));
    }
    CHECK(gone[0] > 0.016);
    CHECK(gone[0] == Approx(gone[1]).epsilon(1e-4));
    CHECK(last[0] == Approx(last[1]).epsilon(1e-3));
}

TEST_CASE("rotation does not flow") {
    Aggregate m = make_block(2, 2, 2, 0.1, kMetal);
    strain_uniformly(m, Quat(Eigen::AngleAxisd(2, Vec3(1, 2, 3).normalized())).toRotationMatrix());
    CellFlow flow(m);
    CHECK(flow.commit(m) == 0);
}

TEST_CASE("whether springs flow is seen from the first cell on, and none flows before") {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> draw(-1, 1);
    const double onset = kMetal.yield_stress / kMetal.young_modulus;
    for (int round = 0; round < 40; ++round) {
        Aggregate m = make_block(11, 2, 2, 0.1, kMetal);
        Mat3 way;
        for (int n = 0; n < 9; ++n) way(n / 3, n % 3) = draw(engine);
        const double bend = 0.3 * draw(engine);
        bool flows = false;
        for (double s = 0.5; !flows; s *= 1.004) {
            for (std::size_t p = 0; p < m.particle_count(); ++p) {
                const Vec3 x = m.particle_reference.at(p);
                const Vec3 u = way * x + Vec3(0, bend * x.x() * x.x(), -2 * bend * x.x() * x.y());
                m.particle_position.set(p, x + s * onset * u);
            }
            CellFlow looks(m), flowed(m);
            Aggregate other = m;
            for (auto& slot : other.cell_plastic) slot.resize(m.cell_fill.size());
            other.cell_history.hardening().resize(m.cell_fill.size());
            looks.rest_strains(m);
            flowed.rest_strains(other);  // looks at every cell
            CHECK(looks.flows() == flowed.flows());
            flows = flowed.flows();
        }
    }
}

TEST_CASE("springs that flow far work as much as the yield stress says") {
    struct Way {
        Mat3 rate;  // of the gradient, without trace
        const char* name;
    };
    const auto diagonal = [](double x, double y, double z) {
        return Mat3(Vec3(x, y, z).asDiagonal());
    };
    Mat3 shear = Mat3::Zero();
    shear(0, 1) = std::sqrt(3.0);
    const Way way =
        GENERATE_COPY(Way{diagonal(1, -.5, -.5), "drawn"}, Way{diagonal(-1, .5, .5), "pressed"},
                      Way{std::sqrt(.75) * diagonal(1, -1, 0), "in a plane"},
                      Way{diagonal(.3, -1.1, .8), "aslant"}, Way{shear, "sheared"});
    INFO(way.name);
    Aggregate m = make_block(2, 1, 1, 0.1, kMetal);
    CellFlow flow(m);
    const double rate = std::sqrt(2.0 / 3) * (0.5 * (way.rate + way.rate.transpose())).norm();
    constexpr double kStep = 0.0025;
    Mat3 gradient = Mat3::Identity();
    double lost = 0, strain = 0;
    for (int n = 1; n <= 320; ++n) {
        // Of second order, and without change of volume.
        const Mat3 half = Mat3::Identity() + 0.5 * kStep * way.rate;
        gradient = (Mat3::Identity() - 0.5 * kStep * way.rate).inverse() * half * gradient;
        gradient /= std::cbrt(gradient.determinant());
        strain_uniformly(m, gradient);
        const double now = flow.commit(m);
        CHECK(now >= 0);
        lost += now, strain += kStep * rate;
        if (n % 80) continue;
        const double taken = m.volume() * kMetal.yield_stress * (strain - 1e-3);
        CHECK(lost == Approx(taken).epsilon(0.01));
        CHECK(m.cell_history.hardening()[0] == Approx(strain - 1e-3).epsilon(0.004));
    }
}

TEST_CASE("springs flow to the same bytes at any width and thread count") {
    Material metal = kMetal;
    const bool curved = GENERATE(false, true);
    if (curved) metal.flow_along({{0, 1e3}, {0.002, 1.2e3}, {0.01, 1.3e3}});
    const auto flowed = [&](int width, int threads) {
        limit_vector_width(width);
        set_thread_count(threads);
        std::mt19937 engine(7);
        std::uniform_real_distribution<double> draw(-1, 1);
        Aggregate m = make_block(29, 9, 9, 0.1, metal);
        for (int n = 0; n < 60; ++n) m.connection[n % 9].weight.set(31 * n, n % 3 * 0.4f);
        CellFlow flow(m);
        std::vector<double> taken;
        for (int step = 0; step < 3; ++step) {
            for (std::size_t p = 0; p < m.particle_count(); ++p) {
                const double far = 1e-3 * m.particle_reference.at(p).x();  // some do not flow
                const Vec3 off(draw(engine), draw(engine), draw(engine));
                m.particle_position.set(p, m.particle_position.at(p) + far * far * 1e2 * off);
            }
            RestGrowths growths;
            taken.push_back(flow.commit(m, Forces::stale, &growths));
            for (const auto& of : growths) {
                for (const RestGrowth& one : of) taken.push_back(one.by);
            }
        }
        std::size_t still = 0;
        for (float alpha : m.cell_history.hardening()) still += alpha == 0;
        CHECK(still > 100);
        CHECK(still < m.cell_fill.size() / 2);
        return std::pair(state_hash(m), taken);
    };
    const auto first = flowed(8, 1);
    for (int width : {4, 2}) CHECK(flowed(width, 1) == first);
    CHECK(flowed(8, 3) == first);
    limit_vector_width(0);
    set_thread_count(0);
}
