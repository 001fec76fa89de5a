// SPDX-License-Identifier: GPL-3.0-or-later
// The books of springs that flow in motion.
#include <algorithm>
#include <cmath>

#include "sim/advance.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/kinetic_energy.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

struct Flattened {
    double remainder, plastic, height;  // over the energy put in; over the height before
};

// A block of clay, of springs that nothing damps or touches, whose halves fly against each other.
Flattened fly(double safety, double speed) {
    const Material clay{.mechanics = Mechanics::springs,
                        .young_modulus = 3e6,
                        .poisson_ratio = 0.25,
                        .density = 1800,
                        .yield_stress = 3e4};
    Aggregate block = make_block(5, 6, 5, 0.01, clay);
    for (std::size_t p = 0; p < block.particle_count(); ++p) {
        block.particle_velocity.y[p] = -speed * block.particle_position.y[p] / 0.03;
    }
    const double energy = kinetic_energy(block);
    SimSettings settings = motion_settings();
    settings.step_safety = safety;
    const Apparatus nothing;
    Simulation simulation(block, nothing, settings);
    FrameReport r;
    for (int n = 0; n < 10; ++n) r = simulation.advance(still(0.002 * n), still(0.002 * (n + 1)));
    const auto [low, high] =
        std::minmax_element(block.particle_position.y.begin(), block.particle_position.y.end());
    return {r.remainder / energy, r.plastic / energy, (*high - *low) / 0.06};
}

}  // namespace

TEST_CASE("what springs that flow in motion leave over falls with the step") {
    for (const double speed : {2.0, 4.0, 8.0}) {
        const Flattened coarse = fly(0.8, speed), fine = fly(0.1, speed);
        INFO(speed << " m/s: remainder " << coarse.remainder << ' ' << fine.remainder
                   << ", plastic " << coarse.plastic << ", height " << coarse.height);
        CHECK(coarse.plastic > 0.45);
        CHECK(std::abs(coarse.remainder) < 6e-4);
        CHECK(std::abs(fine.remainder) < 6e-5);
    }
}
