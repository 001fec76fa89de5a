// SPDX-License-Identifier: GPL-3.0-or-later
// One relaxation of the quasi-static solver.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/interrupt.h"
#include "sim/crushed_cells.h"
#include "sim/quasistatic.h"
#include "sim/relaxation_passes.h"
#include "sim/relaxation_schedule.h"

namespace swage {

namespace {

// Masses under which a step of one is stable. A quarter of the stiffness bound would do for plain
// steps. Contact at 0.26 chatters with friction.
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

}  // namespace

void QuasistaticSolver::find_masses() {
    const std::size_t n = matter_.particle_count();
    std::vector<double> contact(n, 0.0);
    contacts_.add_stiffness(matter_, contact);
    self_.add_stiffness(contact);
    std::vector<double> guard(n, 0.0);
    add_guard_stiffness(matter_, guard);
    mass_.resize(n);
    inverse_mass_.resize(n);
    for (std::size_t p = 0; p < n; ++p) {
        mass_[p] =
            kLatticeMassShare * (lattice_bound_[p] + guard[p]) + kContactMassShare * contact[p];
        inverse_mass_[p] = mass_[p] > 0 ? 1 / mass_[p] : 0;  // a loose particle stays where it is
    }
}

QuasistaticSolver::Relaxation QuasistaticSolver::settle(const Drive& to) {
    const double a = matter_.lattice.spacing;
    Vec3Array& x = matter_.particle_position;
    Vec3Array &v = velocity_, &f = force_;
    const auto stop = [&] {
        for (auto* c : {&v.x, &v.y, &v.z}) std::fill(c->begin(), c->end(), 0.0);
    };
    stop();
    if (!coarse_) coarse_.emplace(matter_);
    coarse_->limit_gain(kGain[0]);
    const auto hold = [&] {
        coarse_->hold(matter_, contacts_.held_points(matter_, to, RestingContacts::Slipping::held),
                      self_.pressed());
    };
    double moved = 0;  // components, since the candidates were listed [m]
    const auto list_candidates = [&] {
        contacts_.find_candidates(matter_, to);
        if (coarse_->is_stale(x)) {
            coarse_->find_stiffness(
                matter_, [&](Vec3Array& force) { lattice_.find(matter_, Flow::none, force); });
        }
        find_masses();
        coarse_->find_masses(mass_);
        hold();
        listed_ = x;
        moved = 0;
    };
    list_candidates();

    const Vec3Array first = x;
    double thrown = 0;  // residual beyond which something was
    bool is_light = true;
    Momentum momentum;
    Relaxation result;
    int renewed = 0, weighted_mirrors = 0, rounds = 0;
    const double whole_mass = std::accumulate(mass_.begin(), mass_.end(), 0.0);
    Patience patience(settings_.iteration_limit, x);
    const int turn = settings_.iteration_limit / int(std::size(kGain));
    for (int iteration = 1; iteration <= patience.limit; ++iteration) {
        throw_if_interrupted();
        result.iterations = iteration;
        if (iteration % turn == 1 && is_light) {
            coarse_->limit_gain(kGain[iteration / turn % std::size(kGain)]);
        }
        patience.watch(iteration, x, a, result.residual);
        evaluate(to, moved);
        if (mirrored_ > weighted_mirrors || self_.has_found_more()) {
            find_masses();
            weighted_mirrors = mirrored_;
        }
        if (iteration % kCheckInterval == 0) {
            result.residual = residual_of(f, to);
            if (!std::isfinite(result.residual)) return result;
            if (thrown == 0) thrown = kThrown * std::max(1.0, result.residual);
            if (result.residual > thrown && is_light) {
                is_light = false;
                coarse_->limit_gain(1);
                x = first;
                stop();
                self_.meet_anew();
                list_candidates();
                momentum = {};
                continue;
            }
            if (result.residual <= accuracy_) {
                result.converged = true;
                if (rounds++ == kMostRounds || !self_.meet_anew()) return result;
                evaluate(to, moved);
                result.residual = residual_of(f, to);
                if (result.residual <= accuracy_) return result;
                result.converged = false;
            }
        }
        const RelaxationSums sums = relaxation_sums(v, f, mass_);
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
        if (coarse_->gains() && mirrored_ == 0) {
            coarse_->add(f, step, keep, v);
            keep = 1;
        }
        moved = move_on({keep, step, step, kLongest * a}, f, inverse_mass_, listed_, v, x);
        if (moved > 0.45 * a) {
            list_candidates();
            result.falls = free_.has_fallen(pushes_, to, start_, body_size_);
            if (result.falls) return result;
        }
    }
    return result;
}

}  // namespace swage
