// SPDX-License-Identifier: GPL-3.0-or-later
// How much of what it can bear matter uses, against what bars bear and the laws themselves.
#include "sim/strength_use.h"

#include <cmath>
#include <numeric>
#include <random>

#include "base/parallel.h"
#include "matter/broken_cells.h"
#include "sim/cracking.h"
#include "sim/lattice_forces.h"
#include "sim/matter_stress.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/equivalent_stress.h"
#include "tests/sim/pulled_bar.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kModulus = 1e6, kYield = 1e3, kRatio = 0.3;

Material metal() {
    return {.young_modulus = kModulus,
            .poisson_ratio = kRatio,
            .yield_stress = kYield,
            .hardening = 2e4};
}
Material brittle() {
    Material m{.young_modulus = kModulus, .poisson_ratio = kRatio};
    m.strength = 1e3, m.toughness = 1.4;
    return m;
}

// As a bar is that is pulled by a strain along x.
void draw(Aggregate& m, double strain) {
    const double thin = std::exp(-kRatio * strain);
    deform(m, [&](const Vec3& x) -> Vec3 {
        return x.cwiseProduct(Vec3(std::exp(strain), thin, thin));
    });
}
// As a bar is that is bent a little about y, its strain along x being that much of z.
void bend(Aggregate& m, double curvature) {
    deform(m, [&](const Vec3& p) -> Vec3 {
        const double x = p.x(), y = p.y(), z = p.z();
        return p +
               curvature * Vec3(x * z, -kRatio * y * z, -0.5 * (x * x + kRatio * (z * z - y * y)));
    });
}

}  // namespace

TEST_CASE(
    "a pulled bar uses its stress over that at which it flows, and what has flowed used all") {
    Aggregate m = make_block(6, 3, 3, 0.1, metal());
    LatticeForces forces(m);
    StrengthUse use(m);
    CHECK(use.beyond(m, 0, 0).yield.share < 1e-6);
    draw(m, 0.6 * kYield / kModulus);
    CHECK(use.beyond(m, 0, 0).yield.share == Approx(0.6).epsilon(1e-3));
    CHECK(use.beyond(m, 0, 0).strength.share == 0);
    CHECK(use.beyond(m, 0.61, 0).yield.share == 0);  // no more than what is known
    // It flows, and is let go of before anyone looks.
    draw(m, 3 * kYield / kModulus);
    REQUIRE(forces.commit(m).plastic > 0);
    draw(m, 2.3 * kYield / kModulus);
    forces.commit(m);
    CHECK(use.beyond(m, 0, 0).yield.share == 1);
    // Nothing has flowed since: what counts is what it bears, over what it flows at now.
    const double now = use.beyond(m, 0, 0).yield.share;
    const std::vector<StressSample> bears = stress_samples(m, {0});
    const double flowed = m.hardening_of(0);
    CHECK(now == Approx(equivalent(bears[0].stress) / (kYield + 2e4 * flowed)).epsilon(1e-3));
    CHECK(now < 0.5);
    CHECK(most_flowed(m).share == flowed);
}

TEST_CASE("a bent bar comes to its yield stress as its surface does, at any number of cells") {
    for (const int across : {1, 2, 4, 8}) {
        for (const Mechanics mechanics : {Mechanics::cells, Mechanics::springs}) {
            Material of = metal();
            of.mechanics = mechanics;
            if (mechanics == Mechanics::springs && across < 8) continue;  // knows its cells alone
            Aggregate m = make_block(3, across, across, 1.0 / across, of);
            StrengthUse use(m);
            const double curvature = 0.5 * kYield / kModulus / 0.5;
            bend(m, curvature);
            const StrengthUse::Most most = use.beyond(m, 0, 0);
            INFO(across << " cells, " << int(mechanics));
            CHECK(most.yield.share ==
                  Approx(0.5).epsilon(mechanics == Mechanics::cells ? 0.01 : 0.2));
            CHECK(std::abs(most.yield.place.z()) == Approx(0.5 - 0.5 / across).margin(0.01));
        }
    }
}

TEST_CASE("no cell bears more than is told, nor flows before all is told of it") {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> draw_number(-1, 1);
    for (const double size : {1e-5, 1e-4, 1e-3, 1e-2}) {
        Material of = metal();
        of.yield_stress = 3 * size * kModulus;
        of.strength = 0.05 * kModulus, of.toughness = 1e6;
        Aggregate m = make_block(4, 4, 4, 0.1, of);
        for (auto* x : {&m.particle_position.x, &m.particle_position.y, &m.particle_position.z}) {
            for (double& c : *x) c += 0.1 * size * draw_number(engine);
        }
        StrengthUse use(m);
        const StrengthUse::Most most = use.beyond(m, 0, 0);
        std::vector<CellId> cells(m.cell_fill.size());
        std::iota(cells.begin(), cells.end(), 0);
        double bears = 0, strain = 0;
        // What is flowed off is not in their stress.
        Aggregate elastic = m;
        elastic.material.yield_stress = std::numeric_limits<double>::infinity();
        for (const StressSample& one : stress_samples(elastic, cells)) {
            bears = std::max(bears, equivalent(one.stress));
        }
        for (const CellRun& run : m.lattice.cell_run) {
            for (int n = 0; n < run.count; ++n) {
                strain = std::max(strain, breaking_strain(m, run, n, 0));
            }
        }
        CHECK(most.yield.share >= 0.999 * std::min(1.0, bears / of.yield_stress));
        CHECK(most.strength.share == Approx(std::min(1.0, strain / 0.05)).epsilon(1e-9));
        LatticeForces forces(m);
        if (forces.commit(m).plastic > 0) CHECK(most.yield.share == 1);
        // The screen lets nothing by: it is found again by whoever knows of a little less.
        StrengthUse again(elastic);
        CHECK(use.beyond(m, 0, 0.999 * most.strength.share).strength.share == most.strength.share);
        CHECK(again.beyond(elastic, 0, 0).yield.share == 0);
    }
}

TEST_CASE("what a back stress has shifted is told against where it flows now") {
    Material of = metal();
    of.back_stress = 800, of.back_strain = 0.01;
    const double firm = 3 * kModulus / 2.6;
    Aggregate m = make_block(4, 2, 2, 0.1, of);
    LatticeForces forces(m);
    const auto put = [&](double strain) {  // of no change of volume
        const double thin = std::exp(-0.5 * strain);
        deform(m, [&](const Vec3& x) -> Vec3 {
            return x.cwiseProduct(Vec3(std::exp(strain), thin, thin));
        });
    };
    put(0.03);
    forces.commit(m);
    StrengthUse use(m);
    CHECK(use.beyond(m, 0, 0).yield.share == Approx(1).epsilon(1e-3));
    const double p = m.hardening_of(0), back = 800 * (1 - std::exp(-p / 0.01));
    const double radius = kYield + 2e4 * p - back;
    // Half the way down to the other side nothing of it is used, though it still bears.
    const double top = kYield + 2e4 * p;
    put(0.03 - radius / firm);
    CHECK(use.beyond(m, 0, 0).yield.share < 0.01);
    CHECK(equivalent(stress_samples(m, {0})[0].stress) == Approx(top - radius).epsilon(1e-2));
    CHECK(equivalent(stress_samples(m, {0}, Bears::of_flow)[0].stress) < 0.01 * radius);
    put(0.03 - 1.9 * radius / firm);
    CHECK(use.beyond(m, 0, 0).yield.share == Approx(0.9).epsilon(1e-2));
    CHECK(stress_samples(m, {0}, Bears::of_flow)[0].yields_at == Approx(radius).epsilon(1e-6));
}

TEST_CASE("a bar uses its strength up to where it breaks, and is told to have used all then") {
    PulledBar bar(make_block(12, 3, 3, 1.0 / 3, brittle()), 4, 1e-6);
    for (Grip& grip : bar.apparatus.grip) grip.hold = Vec3::UnitX();
    bar.start();
    StrengthUse use(bar.matter);
    bool broken = false;
    double last = 0, pulled = 0;
    for (int n = 1; n <= 30 && !broken; ++n) {
        pulled = 4 * 1e-3 * n / 20;
        const FrameReport r = bar.pull_to(pulled);
        broken = any_damaged(bar.matter);
        const StrengthUse::Most most = use.beyond(bar.matter, 0, 0);
        CHECK(most.yield.share == 0);
        if (broken) {
            CHECK(most.strength.share == 1);
        } else {
            CHECK(most.strength.share > last);
            CHECK(most.strength.share == Approx(pull(r) / 1e3).epsilon(0.02));
            last = most.strength.share;
        }
    }
    REQUIRE(broken);
    CHECK(last > 0.9);
    CHECK(last < 1);
    bar.pull_to(0);  // shut again
    CHECK(use.beyond(bar.matter, 0, 0).strength.share == 1);
    // Of a later stage what was broken before counts no more, until it breaks further.
    StrengthUse later(bar.matter);
    CHECK(later.beyond(bar.matter, 0, 0).strength.share < 0.1);
    bar.pull_to(0.5 * pulled);
    CHECK(later.beyond(bar.matter, 0, 0).strength.share < 0.9);
    bar.pull_to(pulled);
    CHECK(later.beyond(bar.matter, 0, 0).strength.share == 1);
}

TEST_CASE("cells too large for a strength are told by the one that they break at") {
    Material of = brittle();
    of.toughness = 0.01;
    const double breaks = breaks_at(of, 0.1);
    REQUIRE(breaks < 0.6 * of.strength);
    Aggregate m = make_block(4, 2, 2, 0.1, of);
    draw(m, 0.5 * breaks / kModulus);
    CHECK(StrengthUse(m).beyond(m, 0, 0).strength.share == Approx(0.5).epsilon(2e-3));
}

TEST_CASE(
    "what is used is the same bytes at any number of threads, and nothing where nothing can be") {
    Material of = metal();
    of.strength = 2e3, of.toughness = 100;
    Aggregate m = make_block(40, 12, 12, 0.1, of);
    bend(m, 1e-4);
    set_thread_count(1);
    const StrengthUse::Most one = StrengthUse(m).beyond(m, 0, 0);
    CHECK(one.yield.share > 0);
    for (const int threads : {2, 3, 8}) {
        set_thread_count(threads);
        const StrengthUse::Most all = StrengthUse(m).beyond(m, 0, 0);
        CHECK(all.yield.share == one.yield.share);
        CHECK(all.yield.place == one.yield.place);
        CHECK(all.strength.place == one.strength.place);
    }
    set_thread_count(0);
    const Aggregate rubber = make_block(2, 2, 2, 0.1, {});
    StrengthUse none(rubber);
    CHECK_FALSE(none.may_flow());
    CHECK_FALSE(none.has_strength());
}
