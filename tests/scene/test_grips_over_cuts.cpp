// SPDX-License-Identifier: GPL-3.0-or-later
// Grips that take hold over what an earlier machine has cut or cracked.
#include "machines/machine.h"
#include "matter/parted.h"
#include "sim/grip_set.h"
#include "tests/catch.h"
#include "tests/machines/bodies.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kA = 0.1;  // a cell

// A bent bar, parted by a plane at x = `place` that leans by `lean` against its cells.
Aggregate bent_bar(double place, double lean, bool is_cut) {
    Aggregate bar = make_block(12, 4, 4, kA, {.young_modulus = 1e6, .poisson_ratio = 0.3});
    deform(bar, [](const Vec3& x) {
        return Vec3(x.x() * (1 - 0.8 * x.y()), x.y() + 0.4 * x.x() * x.x(), x.z());
    });
    const Vec3 normal = Vec3(1, lean, 0.3 * lean).normalized();
    if (is_cut) {
        sever_plane(bar, Vec3(place, 0, 0), normal);
    } else {  // as a crack does, which tells no sides and may leave cells in part
        sever_plane(bar, Vec3(place, 0, 0), normal, [](const Vec3& x) { return x.z() < 0.03; });
    }
    return bar;
}

}  // namespace

TEST_CASE("a grip that begins over a cut or a crack in bent matter neither strains nor moves it") {
    const bool is_cut = GENERATE(true, false);
    const double lean = GENERATE(0.0, 0.2, 0.7), place = GENERATE(-0.23, 0.31);
    CAPTURE(is_cut, lean, place);
    const Aggregate bar = bent_bar(place, lean, is_cut);
    MachineSpec spec;
    spec.name = "vice";
    spec.grip = vice_grips();
    spec.grip[0].to[0] = "-0.05*length";
    spec.grip[1].from[0] = "0.05*length";
    const Machine machine = build_machine(spec, {}, place_work_frame(bar), bar);
    int parted = 0, torn = 0;
    for (const Grip& grip : machine.apparatus.grip) {
        for (int p : grip.point) {
            parted += is_parted(bar, std::size_t(p));
            torn += is_torn(bar, std::size_t(p));
        }
    }
    CHECK(torn > 0);
    if (lean > 0) CHECK(parted > torn);  // their own cells hold the others
    const GripSet grips(bar, machine.apparatus, {}, 0);
    const Drive start = drive_at(machine, 0, 1);
    Vec3Array force;
    force.resize(bar.particle_count());
    grips.add_forces(bar, start, force);
    double most = 0;
    for (std::size_t p = 0; p < force.size(); ++p) most = std::max(most, force.at(p).norm());
    // Of what pulls a cell's face by its own size: places in cells are floats.
    const double modulus = bar.material.young_modulus;
    CHECK(most < 1e-5 * modulus * kA * kA);
    CHECK(grips.stored_energy(bar, start) < 1e-11 * modulus * kA * kA * kA);
}
