// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks of foam (laws/cell_foam.h) between plates.
#include <cmath>

#include "sim/cell_volume.h"
#include "sim/lattice_forces.h"
#include "sim/vector_clones.h"
#include "tests/catch.h"
#include "tests/sim/machines.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSide = 0.1;
constexpr int kFrames = 14;

Aggregate foam_block(double poisson_ratio, int cells = 4) {
    const Material foam{.elasticity = Elasticity::storakers,
                        .young_modulus = 150e3,
                        .poisson_ratio = poisson_ratio,
                        .density = 60,
                        .damping_ratio = 0.2};
    return make_block(cells, cells, cells, kSide / cells, foam);
}

// Over that at first.
double height_of(const Aggregate& m) {
    double high = 0, low = 0, first = 0;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const double at = m.particle_reference.at(p).y(), y = m.particle_position.at(p).y();
        if (std::abs(at) < 0.49 * kSide) continue;
        first += std::abs(at);
        (at > 0 ? high : low) += std::abs(at) / at * y;
    }
    return (high + low) / first;
}
double free_force(double nu, double height) {
    return 150e3 / (2 * (1 + nu)) * kSide * kSide * (std::pow(height, -1 - 2 * nu) - height);
}

// Pressed by such a share of its height; the plates' force at the end [N].
double pressed_force(Aggregate& m, double friction, double down, const SimSettings& settings = {},
                     double time = 1) {
    const Press press{kSide};
    Apparatus apparatus = press.apparatus();
    for (Tool& tool : apparatus.tool) tool.friction = friction, tool.contact_stiffness = 100;
    Simulation simulation(m, apparatus, settings);
    FrameReport r;
    for (int n = 0; n < kFrames; ++n) {
        const double from = double(n) / kFrames, to = double(n + 1) / kFrames;
        r = simulation.advance(press.drive_at(time * from, down * from),
                               press.drive_at(time * to, down * to));
    }
    return std::abs(r.load[1].force.y());
}

}  // namespace

TEST_CASE("foam pressed to 0.6 of its height between smooth plates bears what its law says") {
    for (const double nu : {0.0, 0.1, 0.3}) {
        Aggregate m = foam_block(nu);
        const double force = pressed_force(m, 0, 0.4), height = height_of(m);
        INFO(nu << " height " << height);
        CHECK(height < 0.65);  // the plates' contact gives way
        CHECK(force == Approx(free_force(nu, height)).epsilon(0.01));
        CHECK(smallest_cell_volume(m) == Approx(std::pow(height, 1 - 2 * nu)).epsilon(0.05));
    }
}

TEST_CASE("foam pressed to 0.3 of its height with friction finds its equilibrium") {
    for (const double nu : {0.0, 0.3}) {
        Aggregate m = foam_block(nu);
        const double held = pressed_force(m, 0.3, 0.7), free = free_force(nu, height_of(m));
        INFO(nu << " bears " << held << " at " << height_of(m) << ", free " << free);
        CHECK(held == Approx(free).epsilon(0.1));
        CHECK(height_of(m) < 0.32);
        CHECK(smallest_cell_volume(m) > 0.1);
    }
}

TEST_CASE("pressed foam is the same to the last bit at every width of vectors") {
    std::vector<double> force;
    std::vector<Vec3> place;
    for (const int width : {2, 4, 8}) {
        limit_vector_width(width);
        Aggregate m = foam_block(0.3, 3);
        force.push_back(pressed_force(m, 0.3, 0.5));
        place.push_back(m.particle_position.at(21));
    }
    limit_vector_width(0);
    CHECK(force[1] == force[0]);
    CHECK(force[2] == force[0]);
    CHECK(place[1] == place[0]);
    CHECK(place[2] == place[0]);
}

TEST_CASE(
    "foam let go at 0.3 of its height springs back, by steps that are short where it is stiff") {
    for (const double nu : {0.0, 0.3}) {
        Aggregate m = foam_block(nu);
        const double wide = std::pow(0.3, -nu);
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            const Vec3 x = m.particle_reference.at(p);
            m.particle_position.set(p, x.cwiseProduct(Vec3(wide, 0.3, wide)));
        }
        LatticeForces lattice(m);
        const double held = lattice.elastic_energy(m), crossing = kSide / 50;
        const Apparatus nothing;
        Simulation simulation(m, nothing, motion_settings());
        FrameReport r;
        for (int n = 0; n < 40; ++n)
            r = simulation.advance(still(n * crossing), still((n + 1) * crossing));
        INFO(nu << " remainder " << r.remainder / held);
        CHECK(std::abs(r.remainder) < 0.05 * held);
        CHECK(r.elastic < 0.01 * held);
        CHECK(largest_stretch(m) < 0.05);
    }
}
