// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "geometry/box_mesh.h"
#include "geometry/make_shape.h"
#include "matter/touch_points.h"
#include "mold/mold.h"
#include "sim/advance.h"
#include "sim/connection_shares.h"
#include "sim/surface_modulus.h"
#include "tests/catch.h"

using namespace swage;

namespace {

// A bar of 16 cells in a row, of another material from `boundary` on.
Aggregate row_of_two(const Material& left, const Material& right, double boundary) {
    MoldSettings settings;
    settings.spacing = 0.25;
    const Vec3 size(4, 0.25, 0.25);
    return mold(box_mesh(Vec3::Zero(), size), left, settings,
                {{box_mesh({boundary, 0, 0}, size), right}});
}

Material elastic(double modulus, double damping) {
    Material m;
    m.young_modulus = modulus, m.poisson_ratio = 0.25, m.density = 1, m.damping_ratio = damping;
    return m;
}

Drive at_time(double time) {
    Drive drive;
    drive.time = time;
    return drive;
}

// What its lowest swing along itself has lost of its energy after some periods, as a logarithm.
double lost_by(Aggregate bar, double period, int periods) {
    for (std::size_t p = 0; p < bar.particle_count(); ++p) {
        bar.particle_velocity.x[p] = 1e-4 * std::cos(kPi * bar.particle_reference.at(p).x() / 4);
    }
    const Apparatus nothing;
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    Simulation simulation(bar, nothing, settings);
    double first = 0, last = 0;
    for (int n = 0; n <= periods; ++n) {
        const FrameReport r = simulation.advance(at_time(n * period), at_time((n + 1) * period));
        last = r.kinetic + r.elastic;
        if (n == 0) first = last;
        CHECK(std::abs(r.remainder) < 0.01 * first);
    }
    return std::log(first / last);
}

}  // namespace

TEST_CASE("each of two materials damps with its own damping ratio") {
    // Small ones: what damps is stiffer too.
    const double period = 8;
    const auto lost = [&](double left, double right, double boundary) {
        return lost_by(row_of_two(elastic(1, left), elastic(1, right), boundary), period, 6);
    };
    const double little = lost(0.001, 0.001, 2.1), much = lost(0.005, 0.005, 2.1);
    CHECK(little == Approx(6 * 4 * kPi * 0.001).epsilon(0.15));
    CHECK(much == Approx(6 * 4 * kPi * 0.005).epsilon(0.15));
    // The strain goes as sin(pi x / L): of its energy the left l have l/L - sin(2 pi l/L) / 2 pi.
    for (double boundary : {1.1, 2.0, 2.63}) {
        const double share = boundary / 4 - std::sin(2 * kPi * boundary / 4) / (2 * kPi);
        CHECK(lost(0.001, 0.005, boundary) ==
              Approx(share * little + (1 - share) * much).epsilon(0.03));
        CHECK(lost(0, 0.005, boundary) == Approx((1 - share) * much).epsilon(0.06));
    }
    CHECK(lost(0, 0, 2.1) < 1e-4);
}

TEST_CASE("connections along a series are as soft as it, those beside as stiff as both") {
    const Aggregate m = row_of_two(elastic(1, 0), elastic(100, 0), 2.1);
    REQUIRE(m.mixed_cell.size() == 1);
    const MixedCell& cell = m.mixed_cell[0];
    const double soft = cell.material[0] == 0 ? cell.fill[0] : cell.fill[1];
    CHECK(soft == Approx(0.4).epsilon(1e-5));
    CHECK(stiffness_in(m, cell.cell, &cell, 0) == Approx(1 / (soft + (1 - soft) / 100)));
    CHECK(stiffness_in(m, cell.cell, &cell, 1) == Approx(soft + (1 - soft) * 100));
    // What one of them stores: in series as it gives way.
    const double give = soft + (1 - soft) / 100;
    CHECK(stiffness_in(m, cell.cell, &cell, 0, {1, 0}) == Approx(soft / give / give));
    CHECK(stiffness_in(m, cell.cell, &cell, 1, {1, 0}) == Approx(soft));
    const ConnectionShares shares(m, {});
    const auto corner = m.lattice.cell_corners(cell.cell);
    CHECK(shares.of(m, 0, corner[0]) == Approx(0.25 / give));
}

TEST_CASE("a surface is as stiff as the material just beneath it") {
    const Aggregate m = row_of_two(elastic(1, 0), elastic(100, 0), 2.1);
    const Solver rest = Solver::quasistatic, moves = Solver::explicit_steps;
    const std::vector<double> modulus = surface_moduli(m, m.surface, rest);
    REQUIRE(modulus.size() == m.surface.size());
    for (std::size_t p = 0; p < modulus.size(); ++p) {
        const double x = m.surface_reference(p).x();
        if (std::abs(x - 2.1) > 0.01) CHECK(modulus[p] == (x < 2.1 ? 1.0 : 100.0));
    }
    CHECK(surface_modulus(m, rest) == Approx(1 + 99 * (1.9 + 0.0625) / (4 + 0.125)).epsilon(0.02));
    CHECK(surface_modulus(m, moves) == surface_modulus(m, rest));
    // What keeps its volume is as stiff as that where it is hit.
    Material soft = elastic(1, 0), hard = elastic(100, 0);
    soft.poisson_ratio = hard.poisson_ratio = 0.49;
    const Aggregate rubber = row_of_two(soft, hard, 2.1);
    CHECK(surface_modulus(rubber, rest) == surface_modulus(m, rest));
    CHECK(surface_modulus(rubber, moves) == Approx(surface_modulus(m, rest) / 0.06));
}

TEST_CASE("particles that no cell holds count as the body's own material") {
    Aggregate m = row_of_two(elastic(1, 0), elastic(100, 0), 2.1);
    for (ConnectionArrays& all : m.connection) {
        for (std::size_t p = 0; p < m.particle_count(); ++p) all.weight.set(p, 0);
    }
    const TouchPoints touch(m);
    REQUIRE(touch.size() == touch.own() + m.particle_count());
    const std::vector<double> modulus = surface_moduli(m, touch.points(), Solver::explicit_steps);
    for (std::size_t p = touch.own(); p < touch.size(); ++p) CHECK(modulus[p] == 1);
}

TEST_CASE("a ball with a heavy core falls, bounces and keeps its books in every solver",
          "[stress]") {
    MoldSettings settings;
    settings.spacing = 0.02;
    TriMesh ball = make_shape("sphere", {{"diameter", 0.1}, {"division", 24}}).mesh;
    TriMesh core = make_shape("sphere", {{"diameter", 0.05}, {"division", 24}}).mesh;
    Material rubber;
    rubber.young_modulus = 1e6, rubber.poisson_ratio = 0.45, rubber.density = 1000;
    rubber.elasticity = Elasticity::neo_hookean, rubber.damping_ratio = 0.1;
    Material lead;
    lead.young_modulus = 3e7, lead.poisson_ratio = 0.4, lead.density = 11000;
    lead.yield_stress = 3e5, lead.damping_ratio = 0.02;
    for (Solver solver :
         {Solver::explicit_steps, Solver::euler, Solver::energy_stepped, Solver::implicit_steps}) {
        Aggregate m = mold(ball, rubber, settings, {{core, lead}});
        Apparatus apparatus;
        apparatus.tool.push_back({"floor", BoxShape{Vec3(1, 0.1, 1), 0}, 0.3});
        Drive start;
        start.world_from_tool.push_back({Quat::Identity(), Vec3(0, -0.05, 0)});
        for (double& y : m.particle_position.y) y += 0.1;
        SimSettings sim;
        sim.solver = solver;
        sim.gravity = {0, -9.81, 0};
        Simulation simulation(m, apparatus, sim);
        const double lifted = m.mass() * 9.81 * 0.1;
        double lowest = 1, highest_after = 0;
        FrameReport r;
        Drive from = start;
        for (int n = 1; n <= 20; ++n) {
            Drive to = start;
            to.time = 0.01 * n;
            r = simulation.advance(from, to);
            from = to;
            const double y = m.centre().y();
            if (y < lowest) lowest = y, highest_after = y;
            highest_after = std::max(highest_after, y);
        }
        CHECK(lowest < 0.05);
        CHECK(highest_after > lowest + 0.01);
        CHECK(highest_after < 0.1);
        // Implicit steps lose what swings.
        const double off = solver == Solver::implicit_steps ? 1.0
                           : solver == Solver::euler        ? 0.05
                                                            : 0.02;
        CHECK(std::abs(r.remainder) < off * lifted);
    }
}
