// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/settling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/interrupt.h"
#include "sim/crushed_cells.h"
#include "sim/relaxation_passes.h"
#include "sim/relaxation_schedule.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

// Of stiffnesses. A quarter of the bound would do for plain steps. Contact at 0.26 chatters with
// friction.
constexpr double kLatticeMassShare = 0.5;
constexpr double kContactMassShare = 0.6;
constexpr int kCheckInterval = 10;
constexpr double kFastest = 0.1;  // spacings a step, on the whole
constexpr double kLongest = 0.2;  // of any particle
// How much lighter a slow motion may be: no one number suits all bodies, so they take turns. The
// second is for what next to nothing pushes onto its rests.
constexpr double kGain[] = {300, 1e4, 300, 30, 1};
// Forces beyond so many times the largest push, and beyond those at first, have thrown something:
// what cracks leave loose flies farther than it is held by, the lighter its motion is taken to be.
constexpr double kThrown = 100;
constexpr int kRenewInterval = 50;
// In which points that press on their own body meet it anew once all is at rest. NOTE: a point in
// the crease between two planes meets now the one and now the other, so this need not end.
constexpr int kMostRounds = 4;

// Under which a step of one is stable.
struct StepMasses {
    std::vector<double> mass, inverse;

    void find(StaticForces& forces) {
        const Aggregate& matter = forces.matter;
        const std::size_t n = matter.particle_count();
        std::vector<double> contact(n, 0.0);
        forces.contacts.add_stiffness(matter, contact);
        forces.self.add_stiffness(contact);
        std::vector<double> guard(n, 0.0);
        add_guard_stiffness(matter, guard);
        mass.resize(n);
        inverse.resize(n);
        for (std::size_t p = 0; p < n; ++p) {
            mass[p] = kLatticeMassShare * (forces.stiffness_bound[p] + guard[p]) +
                      kContactMassShare * contact[p];
            inverse[p] = mass[p] > 0 ? 1 / mass[p] : 0;  // a loose particle stays where it is
        }
    }
};

}  // namespace

Relaxation settle(StaticForces& forces, CoarseSpace& coarse, const StaticMove& move,
                  double accuracy, int limit) {
    Aggregate& matter = forces.matter;
    const Drive& to = move.to;
    const double a = matter.lattice.spacing;
    Vec3Array &x = matter.particle_position, &f = forces.force;
    Vec3Array v;
    const auto stop = [&] { set_zero(x.size(), v); };
    stop();
    coarse.limit_gain(kGain[0]);
    const auto hold = [&] {
        coarse.hold(matter,
                    forces.contacts.held_points(matter, to, RestingContacts::Slipping::held),
                    forces.self.pressed());
    };
    StepMasses masses;
    Vec3Array listed;  // positions, when the candidates were found
    double moved = 0;  // components, since the candidates were listed [m]
    const auto list_candidates = [&] {
        forces.contacts.find_candidates(matter, to);
        if (coarse.is_stale(x)) {
            coarse.find_stiffness(
                matter, [&](Vec3Array& force) { forces.lattice.find(matter, Flow::none, force); });
        }
        masses.find(forces);
        coarse.find_masses(masses.mass);
        hold();
        listed = x;
        moved = 0;
    };
    list_candidates();

    const Vec3Array first = x;
    double thrown = 0;  // residual beyond which something was
    bool is_light = true;
    Momentum momentum;
    Relaxation result;
    int renewed = 0, weighted_mirrors = 0, rounds = 0;
    const double whole_mass = std::accumulate(masses.mass.begin(), masses.mass.end(), 0.0);
    Patience patience(limit, x);
    const int turn = limit / int(std::size(kGain));
    for (int iteration = 1; iteration <= patience.limit; ++iteration) {
        throw_if_interrupted();
        result.iterations = iteration;
        if (iteration % turn == 1 && is_light) {
            coarse.limit_gain(kGain[iteration / turn % std::size(kGain)]);
        }
        patience.watch(iteration, x, a, result.residual);
        forces.find(to, moved);
        if (forces.mirrored > weighted_mirrors || forces.self.has_found_more()) {
            masses.find(forces);
            weighted_mirrors = forces.mirrored;
        }
        if (iteration % kCheckInterval == 0) {
            result.residual = forces.residual_of(f, to);
            if (!std::isfinite(result.residual)) return result;
            if (thrown == 0) thrown = kThrown * std::max(1.0, result.residual);
            if (result.residual > thrown && is_light) {
                is_light = false;
                coarse.limit_gain(1);
                x = first;
                stop();
                forces.self.meet_anew();
                list_candidates();
                momentum = {};
                continue;
            }
            if (result.residual <= accuracy) {
                result.converged = true;
                if (rounds++ == kMostRounds || !forces.self.meet_anew()) return result;
                forces.find(to, moved);
                result.residual = forces.residual_of(f, to);
                if (result.residual <= accuracy) return result;
                result.converged = false;
            }
        }
        const RelaxationSums sums = relaxation_sums(v, f, masses.mass);
        double keep = 0;
        if (sums.power > 0) {
            keep = momentum.downhill();
            // A body that is let go must not run into the next tool at full tilt.
            const double way = momentum.step * std::sqrt(sums.motion / whole_mass);
            if (way > kFastest * a) keep *= kFastest * a / way;
        } else {
            momentum.uphill();
            // Other points touch or slip by now.
            if (iteration >= renewed + kRenewInterval) {
                hold();
                renewed = iteration;
            }
        }
        const double step = momentum.step;
        if (coarse.gains() && forces.mirrored == 0) {
            coarse.add(f, step, keep, v);
            keep = 1;
        }
        moved = move_on({keep, step, step, kLongest * a}, f, masses.inverse, listed, v, x);
        if (moved > 0.45 * a) {
            list_candidates();
            result.falls = forces.has_fallen(move);
            if (result.falls) return result;
        }
    }
    return result;
}

}  // namespace swage
