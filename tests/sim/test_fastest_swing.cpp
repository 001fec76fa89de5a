// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/fastest_swing.h"

#include <cmath>
#include <random>

#include "sim/moving_body.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/power_iteration.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.1;

// A surface runs through all cells, and their mass is what they hold.
Aggregate ragged_block(const Material& material) {
    Aggregate m = make_block(7, 5, 6, kSpacing, material);
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> draw(-1, 1);
    m.particle_mass.assign(m.particle_count(), 0.0);
    for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
        m.cell_fill[c] = static_cast<float>(0.52 + 0.48 * draw(engine));
        const double off = 0.5 * (1 - m.cell_fill[c]);
        m.cell_centroid.set(
            c, Eigen::Vector3d(off * draw(engine), off, -off * draw(engine)).cast<float>());
        for (ParticleId p : m.lattice.cell_corners(static_cast<CellId>(c))) {
            m.particle_mass[p] +=
                material.density * m.cell_fill[c] * kSpacing * kSpacing * kSpacing / 8;
        }
    }
    return m;
}

}  // namespace

TEST_CASE("the fastest swing is found from below to a few per cent") {
    for (const Mechanics mechanics : {Mechanics::cells, Mechanics::springs}) {
        for (double ratio : {0.0, 0.25, 0.45}) {
            for (bool ragged : {false, true}) {
                if (ragged && mechanics == Mechanics::springs) continue;
                INFO("nu " << ratio << (ragged ? " ragged" : " block"));
                Material material{.young_modulus = 1e5, .poisson_ratio = ratio};
                material.mechanics = mechanics;
                material.density = 1000;
                const Aggregate m =
                    ragged ? ragged_block(material) : make_block(7, 5, 6, kSpacing, material);
                const double whole = largest_value(m, m.particle_mass, 600),
                             found = fastest_swing_squared(m);
                CHECK(found < 1.002 * whole);
                CHECK(found > 0.93 * whole);
                const double bound = SwingBound(m, false).squared(m, LatticeForces(m));
                CHECK(bound > whole);
                CHECK(bound < 2.01 * whole);
                if (ragged && ratio > 0) {
                    const std::vector<double> plain = LatticeForces(m).stiffness_bound(m);
                    double most = 0;
                    for (std::size_t p = 0; p < plain.size(); ++p) {
                        most = std::max(most, plain[p] / m.particle_mass[p]);
                    }
                    CHECK(most > 1.5 * bound);
                }
            }
        }
    }
}

TEST_CASE("what has flowed thin, was crushed or is about to part shortens the step") {
    Material material{.young_modulus = 1e5, .poisson_ratio = 0.3};
    material.density = 1000, material.yield_stress = 1e3;
    Aggregate m = make_block(5, 4, 4, kSpacing, material);
    const SwingBound bound(m, false);
    const double first = bound.squared(m, LatticeForces(m));
    material.poisson_ratio = 0.1;
    const Aggregate ragged = ragged_block(material);
    CHECK(SwingBound(ragged, true).squared(ragged, LatticeForces(ragged)) >
          1.1 * SwingBound(ragged, false).squared(ragged, LatticeForces(ragged)));
    // To half its height: twice the stretch taken off, four times the stiffness.
    m.cell_history.assign(m.cell_fill.size());
    m.cell_history.row[0][7] = 1.0f;
    const double thin = bound.squared(m, LatticeForces(m));
    CHECK(thin > 1.5 * first);
    // Where it is by now and what it has become do not change what was found as it was molded.
    const double anew = SwingBound(m, false).squared(m, LatticeForces(m));
    CHECK(anew == Approx(thin).epsilon(1e-9));
    for (double& x : m.particle_position.x) x *= 0.01;
    CHECK(SwingBound(m, false).squared(m, LatticeForces(m)) == Approx(thin).epsilon(1e-9));
}
