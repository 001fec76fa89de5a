// SPDX-License-Identifier: GPL-3.0-or-later
// Cells that flow along a curve (laws/flow_curve.h), as the sweep and the books have them.
#include <random>

#include "sim/lattice_forces.h"
#include "sim/vector_clones.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

Material curved() {
    Material m{.young_modulus = 1e6, .poisson_ratio = 0.3};
    m.flow_along({{0, 1e3}, {0.005, 2e3}, {0.01, 2e3}, {0.03, 3e3}, {0.2, 4e3}});
    return m;
}

// Of the curve, and of its integral from 0.
double on_curve(const Material& m, double strain, bool integral = false) {
    double sum = 0;
    for (std::size_t n = 1; n < m.flow_curve.size(); ++n) {
        const auto& [from, low] = m.flow_curve[n - 1];
        const auto& [to, high] = m.flow_curve[n];
        const double end = std::min(strain, to);
        const double there = low + (high - low) * (end - from) / (to - from);
        sum += 0.5 * (low + there) * (end - from);
        if (strain <= to) return integral ? sum : there;
    }
    return integral ? sum + m.flow_curve.back().stress * (strain - m.flow_curve.back().strain)
                    : m.flow_curve.back().stress;
}

void draw_to(Aggregate& m, double strain) {
    const double thin = std::exp(-0.5 * strain);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        m.particle_position.set(p, {std::exp(strain) * x.x(), thin * x.y(), thin * x.z()});
    }
}

// True stress along the way that a uniform block is drawn over that across, its volume kept.
double tension(const Aggregate& m, LatticeForces& forces) {
    Vec3Array f;
    forces.find(m, Flow::trial, f);
    double along = 0, across = 0;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        along -= f.x[p] * m.particle_position.x[p];
        across -= f.y[p] * m.particle_position.y[p];
    }
    return (along - across) / m.volume();
}

}  // namespace

TEST_CASE("a drawn block bears what its flow curve says, in any steps, and books its integral") {
    const Material material = curved();
    constexpr double kStrain = 0.12;
    for (int steps : {1, 3, 40}) {
        Aggregate m = make_block(9, 2, 2, 0.1, material);
        LatticeForces forces(m);
        double lost = 0, bears = 0;
        for (int n = 1; n <= steps; ++n) {
            draw_to(m, kStrain * n / steps);
            bears = tension(m, forces);
            lost += forces.commit(m).plastic;
        }
        const double alpha = m.cell_history.hardening()[0];
        INFO(steps << " steps to " << alpha);
        // All of it is plastic, but for what the stress holds: 3 mu of it is the stress.
        const double shear = material.young_modulus / 2.6;
        CHECK(bears == Approx(on_curve(material, alpha)).epsilon(2e-6));
        CHECK(alpha == Approx(kStrain - bears / (3 * shear)).epsilon(1e-5));
        CHECK(lost == Approx(m.volume() * on_curve(material, alpha, true)).epsilon(2e-6));
    }
}

TEST_CASE("matter that flows along a curve has the same bytes by vectors of any width") {
    std::vector<std::vector<double>> force;
    std::vector<std::vector<float>> gathered;
    for (int width : {8, 4, 2}) {
        limit_vector_width(width);
        Aggregate m = make_block(11, 3, 3, 0.1, curved());
        std::mt19937 engine(9);
        std::uniform_real_distribution<double> draw(-1, 1);
        LatticeForces forces(m);
        for (int step = 0; step < 3; ++step) {
            for (auto* x :
                 {&m.particle_position.x, &m.particle_position.y, &m.particle_position.z}) {
                for (double& v : *x) v += 0.003 * draw(engine);
            }
            CHECK(forces.commit(m).plastic > 0);
        }
        Vec3Array f;
        forces.find(m, Flow::trial, f);
        force.push_back(f.x);
        gathered.push_back(m.cell_history.hardening());
    }
    limit_vector_width(0);
    for (int other : {1, 2}) {
        CHECK(force[other] == force[0]);
        CHECK(gathered[other] == gathered[0]);
    }
}
