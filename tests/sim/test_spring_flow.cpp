// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of springs that flow under pressures of many times their yield stress.
#include "sim/cell_volume.h"
#include "sim/flowed_volume.h"
#include "tests/sim/loads_fixture.h"
#include "tests/sim/machines.h"

using namespace swage;
using namespace swage::test;

namespace {

// As soft beside its stiffness as tin.
Material soft(Mechanics mechanics) {
    return {.mechanics = mechanics,
            .young_modulus = 44e9,
            .poisson_ratio = 0.25,
            .density = 7290,
            .yield_stress = 11e6,
            .hardening = 20e6};
}

struct Wrung {
    double work = 0, volume = 0, flowed = 0;
};

// By its ends, which are held, by a quarter of a turn.
Wrung wring(Mechanics mechanics) {
    Aggregate bar = make_block(10, 3, 3, 5e-3, soft(mechanics));
    const double end = 0.5 * 10 * 5e-3;
    Apparatus apparatus;
    for (const double side : {-1.0, 1.0}) {
        apparatus.grip.push_back(hold(
            bar, points_where(bar, [&](const Vec3& x) { return side * x.x() > end - 5.1e-3; })));
    }
    SimSettings settings;
    settings.iteration_limit = 1000;
    settings.halving_limit = 2;
    const auto drive = [&](double share) {
        Drive d = still(share);
        for (const double side : {-1.0, 1.0}) {
            const double turn = side * share * kPi / 4;
            d.world_from_grip.push_back(
                {Quat(Eigen::AngleAxisd(turn, Vec3::UnitX())), Vec3::Zero()});
        }
        return d;
    };
    Simulation simulation(bar, apparatus, settings);
    Wrung wrung;
    for (int n = 0; n < 6; ++n) {
        wrung.work = simulation.advance(drive(n / 6.0), drive((n + 1) / 6.0)).work;
    }
    wrung.volume = present_volume(bar) / bar.volume();
    wrung.flowed = flowed_volume(bar);
    return wrung;
}

}  // namespace

TEST_CASE("springs that flow far beyond yield in one step come to rest, and keep their volume") {
    const Wrung springs = wring(Mechanics::springs), cells = wring(Mechanics::cells);
    CAPTURE(springs.work, cells.work, springs.volume, springs.flowed);
    CHECK(springs.work == Approx(cells.work).epsilon(0.25));
    CHECK(springs.volume == Approx(1).margin(2e-3));
    CHECK(springs.flowed == Approx(1).margin(2e-3));
    CHECK(cells.flowed == Approx(1).margin(1e-4));
}
