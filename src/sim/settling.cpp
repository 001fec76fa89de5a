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
constexpr double kRelist = 0.45;  // spacings that any may go before candidates are found anew
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

// A relaxation under way.
class Settling {
  public:
    Settling(StaticForces& forces, CoarseSpace& coarse, const StaticMove& move, double accuracy,
             int limit)
        : forces_(forces),
          coarse_(coarse),
          move_(move),
          accuracy_(accuracy),
          turn_(limit / int(std::size(kGain))),
          patience_(limit, x_) {
        stop();
        coarse_.limit_gain(kGain[0]);
        list_candidates();
        first_ = x_;
        whole_mass_ = std::accumulate(masses_.mass.begin(), masses_.mass.end(), 0.0);
    }

    Relaxation run() {
        for (int iteration = 1; iteration <= patience_.limit; ++iteration) {
            throw_if_interrupted();
            result_.iterations = iteration;
            if (iteration % turn_ == 1 && is_light_) {
                coarse_.limit_gain(kGain[iteration / turn_ % std::size(kGain)]);
            }
            patience_.watch(iteration, x_, spacing_, result_.residual);
            find_forces();
            const Next next = iteration % kCheckInterval == 0 ? check() : Next::step;
            if (next == Next::end) break;
            if (next == Next::anew) continue;
            step(iteration);
            if (moved_ > kRelist * spacing_) {
                list_candidates();
                result_.falls = forces_.has_fallen(move_);
                if (result_.falls) break;
            }
        }
        return result_;
    }

  private:
    enum class Next { step, anew, end };

    void stop() { set_zero(x_.size(), v_); }

    void hold() {
        coarse_.hold(
            forces_.matter,
            forces_.contacts.held_points(forces_.matter, move_.to, RestingContacts::Slipping::stuck),
            forces_.self.pressed());
    }

    void list_candidates() {
        forces_.contacts.find_candidates(forces_.matter, move_.to);
        if (coarse_.is_stale(x_)) {
            coarse_.find_stiffness(forces_.matter, [&](Vec3Array& force) {
                forces_.lattice.find(forces_.matter, Flow::none, force);
            });
        }
        masses_.find(forces_);
        coarse_.find_masses(masses_.mass);
        hold();
        listed_ = x_;
        moved_ = 0;
    }

    void find_forces() {
        forces_.find(move_.to, moved_);
        if (forces_.mirrored > weighted_mirrors_ || forces_.self.has_found_more()) {
            masses_.find(forces_);
            weighted_mirrors_ = forces_.mirrored;
        }
    }
    double residual() const { return forces_.residual_of(forces_.force, move_.to); }

    Next check() {
        result_.residual = residual();
        if (!std::isfinite(result_.residual)) return Next::end;
        if (thrown_ == 0) thrown_ = kThrown * std::max(1.0, result_.residual);
        if (result_.residual > thrown_ && is_light_) {
            begin_heavy();
            return Next::anew;
        }
        if (result_.residual > accuracy_) return Next::step;
        return rests_anew() ? Next::end : Next::step;
    }
    // From where it began, with no motion lighter than it is.
    void begin_heavy() {
        is_light_ = false;
        coarse_.limit_gain(1);
        x_ = first_;
        stop();
        forces_.self.meet_anew();
        list_candidates();
        momentum_ = {};
    }
    // Whether what is at rest is so still once its points have met it anew.
    bool rests_anew() {
        result_.converged = true;
        if (rounds_++ == kMostRounds || !forces_.self.meet_anew()) return true;
        forces_.find(move_.to, moved_);
        result_.residual = residual();
        result_.converged = result_.residual <= accuracy_;
        return result_.converged;
    }

    void step(int iteration) {
        const RelaxationSums sums = relaxation_sums(v_, forces_.force, masses_.mass);
        double keep = 0;
        if (sums.power > 0) {
            keep = momentum_.downhill();
            // A body that is let go must not run into the next tool at full tilt.
            const double way = momentum_.step * std::sqrt(sums.motion / whole_mass_);
            if (way > kFastest * spacing_) keep *= kFastest * spacing_ / way;
        } else {
            momentum_.uphill();
            // Other points touch or slip by now.
            if (iteration >= renewed_ + kRenewInterval) {
                hold();
                renewed_ = iteration;
            }
        }
        const double step = momentum_.step;
        if (coarse_.gains() && forces_.mirrored == 0) {
            coarse_.add(forces_.force, step, keep, v_);
            keep = 1;
        }
        moved_ = move_on({keep, step, step, kLongest * spacing_}, forces_.force, masses_.inverse,
                         listed_, v_, x_);
    }

    StaticForces& forces_;
    CoarseSpace& coarse_;
    const StaticMove& move_;
    const double accuracy_;
    const int turn_;  // iterations for each gain
    Vec3Array& x_ = forces_.matter.particle_position;
    const double spacing_ = forces_.matter.lattice.spacing;
    Vec3Array v_;
    Vec3Array first_;   // positions at the beginning
    Vec3Array listed_;  // and when the candidates were found
    double moved_ = 0;  // components, since then [m]
    StepMasses masses_;
    double whole_mass_;
    double thrown_ = 0;  // residual beyond which something was
    bool is_light_ = true;
    int renewed_ = 0, weighted_mirrors_ = 0, rounds_ = 0;
    Momentum momentum_;
    Patience patience_;
    Relaxation result_;
};

}  // namespace

Relaxation settle(StaticForces& forces, CoarseSpace& coarse, const StaticMove& move,
                  double accuracy, int limit) {
    return Settling(forces, coarse, move, accuracy, limit).run();
}

}  // namespace swage
