// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/crushed_cells.h"

#include <random>

#include "laws/volume_guard.h"
#include "sim/cell_volume.h"
#include "tests/catch.h"
#include "tests/sim/force_checks.h"
#include "tests/sim/machines.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSide = 0.1;

// Two cells thick, partly filled in one layer.
Aggregate shaken_block(const Material& material, bool flowed) {
    std::mt19937 random(5);
    const auto draw = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Aggregate m = make_block(3, 2, 2, kSide, material);
    for (std::size_t c = 0; c < m.cell_fill.size(); c += 2) {
        Eigen::Vector3f centroid;
        m.cell_fill[c] = static_cast<float>(draw(0.05, 0.9));
        for (float& at : centroid) at = static_cast<float>(draw(-0.4, 0.4));
        m.cell_centroid.set(c, centroid);
    }
    if (flowed) {
        const std::size_t cells = m.cell_fill.size();
        m.cell_history.assign(cells);
        auto& stretch = m.cell_history.row;
        for (std::size_t c = 0; c < cells; ++c) {
            const double x = draw(-1, 1), y = draw(-1, 1);
            stretch[0][c] = static_cast<float>(std::expm1(x));
            stretch[1][c] = static_cast<float>(std::expm1(y));
            stretch[2][c] = static_cast<float>(std::expm1(-x - y));
            for (int n = 3; n < 6; ++n) stretch[n][c] = static_cast<float>(draw(-0.1, 0.1));
        }
        for (int n = 6; n < 18; ++n) {
            for (float& v : m.cell_history.row[n]) v = static_cast<float>(draw(-0.2, 0.2) * kSide);
        }
        m.cell_history.hardening().assign(cells, 1.0f);
    }
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p).cwiseProduct(Vec3(1.1, 0.35, 0.9));
        m.particle_position.set(p, x + 0.1 * kSide * Vec3(draw(-1, 1), draw(-1, 1), draw(-1, 1)));
    }
    return m;
}

}  // namespace

TEST_CASE("forces of crushed matter are minus the slope of its energy, whatever it has flowed") {
    Material elastic{.young_modulus = 1e6, .poisson_ratio = 0.4}, rubber = elastic, flows = elastic;
    Material foam = elastic;
    rubber.elasticity = Elasticity::neo_hookean, foam.elasticity = Elasticity::storakers;
    flows.yield_stress = 1e30;  // it has flowed, and does not flow on
    for (const Material& material : {elastic, rubber, foam, flows}) {
        Aggregate m = shaken_block(material, std::isfinite(material.yield_stress));
        int crushed = 0, inverted = 0;
        for (const SmallCell& cell : cells_below(m, kGuardedVolume)) {
            ++crushed;
            inverted += cell.volume < 0;
        }
        CHECK(crushed >= 4);
        LatticeForces forces(m);
        Vec3Array f;
        CHECK(forces.find(m, Flow::trial, f) == inverted);
        CHECK(forces.elastic_energy(m) > 0);
        double largest = 0;
        for (std::size_t p = 0; p < f.size(); ++p) largest = std::max(largest, f.at(p).norm());
        const double h = 1e-5 * kSide;
        for (std::size_t p = 0; p < m.particle_count(); p += 3) {
            const double slope = energy_slope(forces, m, p, 1, h);
            CHECK(f.y[p] == Approx(-slope).margin(1e-6 * largest));
        }
    }
}

TEST_CASE("clay that is pressed flat keeps its volume, to a fifth of its height") {
    const Material clay{.young_modulus = 3e6, .poisson_ratio = 0.45, .yield_stress = 3e4};
    Aggregate m = make_block(4, 4, 4, kSide / 4, clay);
    const Press press{kSide};
    const Apparatus apparatus = press.apparatus();
    Simulation simulation(m, apparatus, SimSettings{});
    constexpr int kFrames = 16;
    for (int n = 0; n < kFrames; ++n) {
        const double from = double(n) / kFrames, to = double(n + 1) / kFrames;
        const FrameReport r =
            simulation.advance(press.drive_at(from, 0.8 * from), press.drive_at(to, 0.8 * to));
        CHECK(r.elastic >= 0);
    }
    double volume = 0;
    for (const SmallCell& cell : cells_below(m, 1e9)) volume += cell.volume;
    CHECK(volume / 64 == Approx(1).margin(0.01));
}
