// SPDX-License-Identifier: GPL-3.0-or-later
// How far a body has come by itself, and what is left over would still take it. NOTE: counted with
// what tools carry along, a bar that was drawn by half was let rest with ten times as much left
// over, and its neck went off its middle.
#include <cmath>

#include "sim/lattice_forces.h"
#include "sim/newton.h"
#include "sim/vector_sums.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr int kLong = 24;
constexpr double kSpacing = 0.1, kLength = kLong * kSpacing, kDrawn = 0.2;

// Thinnest along y, between ends that are held where they are drawn to.
struct DrawnBar {
    Aggregate matter =
        make_block(kLong, 2, 3, kSpacing, {.young_modulus = 1e6, .poisson_ratio = 0.3});
    LatticeForces lattice{matter};
    Newton newton{matter, *lattice.cells_alone()};
    std::vector<int> ends =
        points_where(matter, [](const Vec3& x) { return std::abs(x.x()) > 0.5 * kLength - 1e-9; });
    Vec3Array first = matter.particle_position, push;  // where it began; besides [N]

    DrawnBar() {
        set_zero(matter.particle_count(), push);
        for (double& x : matter.particle_position.x) x *= 1 + kDrawn;
    }
    NewtonProblem problem() {
        constexpr double kHeld = 1e6;  // [N/m]
        NewtonProblem p;
        p.forces = [&](Vec3Array& force) {
            lattice.find(matter, Flow::trial, force);
            combine(1, 1, push, force);
            for (int n : ends) {
                const HeldPoint h = held_point(matter.surface, n, kHeld * Mat3::Identity());
                const Vec3 at = matter.surface_reference(n);
                const Vec3 off = matter.surface_position(n) - at - Vec3(kDrawn * at.x(), 0, 0);
                for (int c = 0; c < 8; ++c) force.add(h.corner[c], -h.weight[c] * kHeld * off);
            }
        };
        p.residual = [](const Vec3Array& force) { return std::sqrt(dot(force, force)); };
        p.tolerance = 1e-4;
        for (int n : ends) {
            p.held.push_back(held_point(matter.surface, n, kHeld * Mat3::Identity()));
        }
        p.diagonal = lattice.stiffness_bound(matter);
        for (const HeldPoint& h : p.held) {
            for (int c = 0; c < 8; ++c) p.diagonal[h.corner[c]] += kHeld * h.weight[c];
        }
        p.drag.assign(matter.particle_count(), 0.0);
        return p;
    }
};

}  // namespace

TEST_CASE("how far a body has come by itself counts nothing that tools carry along") {
    DrawnBar bar;
    REQUIRE(bar.newton.solve(bar.matter, bar.problem()).converged);
    const Vec3Array drawn = bar.matter.particle_position, &first = bar.first;
    const double carried = farthest_move(drawn, first);
    REQUIRE(carried > 0.9 * kDrawn * kLength / 2);
    // What pushes its middle aside, and how far that would take it.
    Vec3Array push;
    set_zero(bar.matter.particle_count(), push);
    for (std::size_t p = 0; p < push.size(); ++p) {
        if (std::abs(first.x[p]) < 0.2 * kLength) push.y[p] = 0.1;
    }
    Newton::Astray found;
    for (int look = 0; look < 4; ++look) {  // the motion is followed from one to the next
        found = bar.newton.astray(bar.matter, bar.problem(), push, first);
    }
    CHECK(found.gone < 1e-3 * carried);
    bar.push = push;
    REQUIRE(bar.newton.solve(bar.matter, bar.problem()).converged);
    const double aside = farthest_move(bar.matter.particle_position, drawn);
    CHECK(aside < 0.1 * carried);
    CHECK(found.left == Approx(aside).epsilon(0.2));
    // And having gone there it has come so far.
    const Newton::Astray there = bar.newton.astray(bar.matter, bar.problem(), push, first);
    CHECK(there.gone == Approx(aside).epsilon(0.2));
}
