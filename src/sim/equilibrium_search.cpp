// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/equilibrium_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/settling.h"
#include "sim/surface_forces.h"
#include "sim/vector_sums.h"
#include "sim/wrinkled_foam.h"

namespace swage {

namespace {

constexpr double kNudge = 0.02;  // spacings: the least that a body that buckles is moved
constexpr int kMostTurns = 4;
constexpr double kDriven = 0.03;  // of what drives a body along as it buckles may be left over
constexpr double kFinest = 1e-4;  // of the tolerance: less is never asked for
constexpr double kWithin = 0.1;   // of a motion along the surface: what it goes across
constexpr double kAstray = 0.01;  // of the way that the body has gone
// Of what flows, what leading it aside strains it by: of what varies as straight as a beam's
// strain, no end is more than twice the mean, of a wave along it no crest more than pi/2 times.
constexpr double kLed = 0.3;
constexpr double kLedEnough = 0.3;  // spacings

// Share of the drag that Newton's method goes ahead with, and that stays when it is found to hold
// the body back.
constexpr double kSmoothHold = 1e-3, kLetGo = 0.1;
constexpr int kLongestPause = 16;

// NOTE: the tangent knows nothing of how a pressure turns with the surface. Without it a free body
// under pressure seems to gain by turning over.
bool floats_under_pressure(const Apparatus& apparatus) {
    return apparatus.grip.empty() &&
           std::any_of(apparatus.load.begin(), apparatus.load.end(),
                       [](const Load& load) { return load.force.empty() && load.pressure != 0; });
}

// With `hold` of the drag.
NewtonProblem problem_of(StaticForces& forces, const Drive& to, double accuracy,
                         RestingContacts::Slipping slipping, double hold) {
    NewtonProblem problem;
    problem.forces = [&](Vec3Array& force) {
        forces.find(to);
        force = forces.force;
    };
    problem.residual = [&](const Vec3Array& force) { return forces.residual_of(force, to); };
    problem.tolerance = accuracy;
    problem.held = forces.contacts.held_points(forces.matter, to, slipping);
    problem.diagonal = forces.stiffness_bound;
    forces.contacts.add_stiffness(forces.matter, problem.diagonal);
    problem.drag.resize(forces.drag.size());
    for (std::size_t p = 0; p < forces.drag.size(); ++p) {
        problem.drag[p] = hold * forces.drag[p];
    }
    return problem;
}

// The drag that whether a body gives way is asked with. NOTE: all of it holds a slender one at up
// to 1.2 times what it bears.
double little_hold(const StaticForces& forces) { return std::min(forces.hold, kSmoothHold); }

// What slips would stick if turned back.
NewtonProblem buckling_problem(StaticForces& forces, const Drive& to, double accuracy) {
    return problem_of(forces, to, accuracy, RestingContacts::Slipping::held, little_hold(forces));
}

// To either side along this way, as far as the forces drive the body there, with the drag that it
// was found to give way by. Returns what drives it along that way, where it gets to, as a residual;
// 0, and leaves it, where they drive it to neither side.
double go_along(StaticForces& forces, const Drive& to, const Vec3Array& way) {
    Vec3Array& x = forces.matter.particle_position;
    const std::vector<double>& mass = forces.matter.particle_mass;
    const double a = forces.matter.lattice.spacing, longest = longest_of(way);
    const Vec3Array from = x;
    const double hold = std::exchange(forces.hold, little_hold(forces));
    const auto work_at = [&](double far) {
        x = from;
        combine(1, far / longest, way, x);
        forces.find(to);
        return far > 0 ? dot(forces.force, way) : -dot(forces.force, way);
    };
    double far = kNudge * a;
    if (work_at(-far) > work_at(far)) far = -far;
    const bool driven = work_at(far) > 0;
    while (driven && std::abs(far) < a && work_at(2 * far) > 0) far *= 2;
    const double work = work_at(driven ? far : 0);
    forces.hold = hold;
    if (!driven) return 0;
    // The rest is what a straight way has strained, which goes at once, and is far more.
    const double size =
        chunked_sum(way.size(), [&](std::size_t p) { return mass[p] * way.at(p).squaredNorm(); });
    Vec3Array drive = way;
    for (std::size_t p = 0; p < way.size(); ++p) {
        drive.set(p, work / size * mass[p] * way.at(p));
    }
    return forces.residual_of(drive, to);
}

// Whether it takes the matter round within its shape, as it would a ball between smooth plates: of
// what is round that is neutral, and no buckling, whatever the lattice makes of it.
bool keeps_the_shape(const Aggregate& matter, const Vec3Array& way) {
    double across = 0, all = 0;
    for (std::size_t n = 0; n < matter.surface.size(); ++n) {
        const Vec3 area = surface_area_vector(matter, int(n));
        const SurfacePoints::Carriers by = matter.surface.carriers(n);
        Vec3 goes = Vec3::Zero();
        for (int c = 0; c < 8; ++c) goes += by.weight[c] * way.at(by.corner[c]);
        const double size = area.norm();
        if (!(size > 0)) continue;
        across += area.dot(goes) * area.dot(goes) / size;
        all += size * goes.squaredNorm();
    }
    return across < kWithin * kWithin * all;
}

// What is in some grip, or all, has gone [m]: other pieces go anywhere.
double farthest(const StaticForces& forces, const Vec3Array& from) {
    Vec3Array gone = forces.matter.particle_position;
    combine(1, -1, from, gone);
    for (const std::vector<ParticleId>& piece : forces.free.loose_pieces()) {
        for (ParticleId p : piece) gone.set(p, Vec3::Zero());
    }
    return longest_of(gone);
}

// That what is left over may take a body which has gone so far [m].
double farthest_astray(const Aggregate& matter, double gone) {
    return kAstray * (gone + kNudge * matter.lattice.spacing);
}

// How far that is along this motion, if any [spacings].
double gone_along(const Aggregate& matter, const Vec3Array& motion, const Vec3Array& start) {
    if (motion.size() == 0) return 0;
    return gone_by(matter, motion, start) * longest_of(motion) / matter.lattice.spacing;
}

void look_around(StaticForces& forces, const Drive& to) {
    forces.contacts.find_candidates(forces.matter, to);
    forces.self.meet_anew();
}

}  // namespace

EquilibriumSearch::EquilibriumSearch(const StaticForces& forces, const SimSettings& settings)
    : tolerance_(settings.tolerance),
      iteration_limit_(settings.iteration_limit),
      begun_at_(forces.matter.particle_position) {
    connections_changed(forces);
}

void EquilibriumSearch::connections_changed(const StaticForces& forces) {
    coarse_.reset();
    const std::vector<float>* cells = forces.lattice.cells_alone();
    newton_ = cells != nullptr ? std::make_unique<Newton>(forces.matter, *cells) : nullptr;
}

Relaxation EquilibriumSearch::solve_smooth(StaticForces& forces, const StaticMove& move,
                                           double accuracy) {
    NewtonProblem problem =
        problem_of(forces, move.to, accuracy, RestingContacts::Slipping::free, forces.hold);
    problem.gives_way = has_buckled_;
    const Newton::Result found = newton_->solve(forces.matter, std::move(problem));
    look_around(forces, move.to);  // steps that were not kept have met other things
    const bool converged = found.converged && forces.mirrored == 0;
    newton_pause_ = converged ? 0 : std::clamp(2 * newton_pause_, 1, kLongestPause);
    newton_rests_ = newton_pause_;
    const bool over = converged && newton_->has_gone_over(forces.matter, move.start) &&
                      !keeps_the_shape(forces.matter, newton_->gave_way_by());
    return {converged, found.steps, found.residual, false, over};
}

// The drag is let go until what it holds back is no more than the residual may be, from where that
// was so in the move before. NOTE: loose pieces would fly off with what little drag that was.
Relaxation EquilibriumSearch::relax(StaticForces& forces, const StaticMove& move, double accuracy) {
    Relaxation result;
    Vec3Array& x = forces.matter.particle_position;
    forces.held = move.rest;
    look_around(forces, move.to);
    bool smooth = newton_ && newton_rests_ == 0 && !forces.touches() &&
                  !floats_under_pressure(forces.apparatus);
    const double first = forces.free.are_several() ? 1 : std::exchange(enough_hold_, 1);
    for (forces.hold = smooth ? kSmoothHold : first;; forces.hold *= kLetGo) {
        Relaxation round;
        if (smooth) {
            const Vec3Array before = x;
            round = solve_smooth(forces, move, accuracy);
            if (round.converged && forces.has_fallen(move)) {
                return {false, result.iterations + round.iterations, round.residual, true};
            }
            if (!round.converged || forces.touches()) {
                x = before;
                smooth = false;
                forces.hold = first;
            }
        }
        if (!smooth) {
            if (!coarse_) coarse_.emplace(forces.matter);
            round = settle(forces, *coarse_, move, accuracy, iteration_limit_);
        }
        result = {round.converged, result.iterations + round.iterations, round.residual,
                  round.falls, result.buckled || round.buckled};
        if (!round.converged) return result;
        const double dragged = forces.hold * chunked_sum(x.size(), [&](std::size_t p) {
                                   return forces.drag[p] * (x.at(p) - forces.held.at(p)).norm();
                               });
        if (dragged <= accuracy * forces.push_measure(move.to)) {
            if (!smooth) enough_hold_ = forces.hold;
            return result;
        }
        forces.held = x;
    }
}

// What flows and would buckle by its tangent modulus is led aside until it goes by itself.
bool EquilibriumSearch::lead_aside(Aggregate& matter, StaticMove& move) {
    if (!matter.yields() || matter.cell_history.empty()) return false;
    const Vec3Array& way = newton_->softest_motion();
    const FlowAside flow(matter, way);
    if (!newton_->buckles_in_flow(flow) || keeps_the_shape(matter, way)) return false;
    const double gone = gone_along(matter, way, begun_at_);
    if (std::abs(gone) > kLedEnough) return false;
    move.history = matter.cell_history;
    const double by = std::copysign(kLed * flow.as_far_as_flow(), gone);
    flow.commit(matter, by);
    combine(1, by, way, matter.particle_position);
    const bool is_far = std::abs(gone_along(matter, led_by_, begun_at_)) > kLedEnough;
    if (led_by_.size() == 0) set_zero(matter.particle_count(), led_by_);
    if (!is_far) combine(1, by, way, led_by_);
    return true;
}

// Whether what was led aside goes beyond so far in this move along that way, by itself or not.
bool EquilibriumSearch::goes_far_aside(const Aggregate& matter, const StaticMove& move) {
    const double gone = gone_along(matter, led_by_, begun_at_);
    const double by = gone_along(matter, led_by_, move.start);
    if (gone * by < 0) led_by_ = {};
    return gone * by > 0 && std::abs(gone) > kLedEnough && std::abs(gone - by) <= kLedEnough;
}

// A body that buckles is moved the way it wants to go, as far as the forces drive it there, and
// comes to rest from there. What a slender body's push leaves over may be nothing beside the push,
// and yet take it far: then less has to be left.
Relaxation EquilibriumSearch::find(StaticForces& forces, StaticMove& move) {
    newton_rests_ = std::max(0, newton_rests_ - 1);
    const Aggregate& matter = forces.matter;
    Vec3Array& x = forces.matter.particle_position;
    double accuracy = tolerance_;
    Relaxation result = relax(forces, move, accuracy);
    const auto again = [&](double wanted) {
        accuracy = wanted;
        const Relaxation next = relax(forces, move, accuracy);
        result = {next.converged, result.iterations + next.iterations, next.residual, next.falls,
                  result.buckled || next.buckled};
    };
    // Or stays where it was.
    const auto try_again = [&](double wanted, const Vec3Array& there) {
        const Relaxation rest = result;
        again(wanted);
        if (result.converged) return true;
        x = there;
        result = {true, result.iterations, rest.residual, false, rest.buckled};
        return false;
    };
    const auto leave_less = [&] { return try_again(0.1 * accuracy, Vec3Array(x)); };
    // What was cut, or lost its grips, has no push to measure by, and a tangent only where Newton's
    // method serves.
    const bool tried = move.let_go && !newton_ && !forces.touches();
    while (tried && result.converged && accuracy >= kFinest * tolerance_) {
        const Vec3Array before = x;
        if (!leave_less()) break;
        const double gone = farthest(forces, begun_at_);
        if (farthest(forces, before) <= farthest_astray(matter, gone)) break;
    }
    bool led = false;
    for (int turn = 0; turn < kMostTurns && newton_ && result.converged;) {
        if (floats_under_pressure(forces.apparatus) || forces.self.presses()) break;
        if (foam_wrinkles(matter)) break;
        const NewtonProblem problem = buckling_problem(forces, move.to, accuracy);
        if (problem.held.empty()) break;  // what nothing bears on has nothing to give way to
        if (!newton_->buckles(matter, problem, forces.push_measure(move.to))) {
            const Vec3Array there = x, led_by = led_by_;
            if (!led && lead_aside(forces.matter, move)) {
                led = true;
                if (!try_again(accuracy, there)) {
                    forces.matter.cell_history = std::exchange(move.history, {});
                    led_by_ = led_by;
                }
                continue;
            }
            if (forces.touches() || accuracy < kFinest * tolerance_) break;
            const double hold = std::exchange(forces.hold, 0);  // it holds back what is left over
            forces.find(move.to);
            forces.hold = hold;
            const Newton::Astray way = newton_->astray(matter, problem, forces.force, begun_at_);
            if (way.left <= farthest_astray(matter, way.gone) || !leave_less()) break;
            continue;
        }
        if (keeps_the_shape(matter, newton_->softest_motion())) break;
        ++turn;
        // The forces know more than the tangent does: how a pressure turns with the surface.
        const double drive = go_along(forces, move.to, newton_->softest_motion());
        if (!(drive > 0)) break;
        move.rest = x;
        newton_rests_ = 0;  // it may have failed for what gives way here
        has_buckled_ = true;
        again(std::clamp(kDriven * drive, kFinest * tolerance_, tolerance_));
        // What falls far takes long.
        for (int more = 0; more < kMostTurns && !result.converged; ++more) {
            move.rest = x;
            again(tolerance_);
        }
        result.buckled = true;
    }
    if (result.converged && goes_far_aside(matter, move)) result.buckled = true;
    has_buckled_ = has_buckled_ || (result.converged && result.buckled);
    return result;
}

}  // namespace swage
