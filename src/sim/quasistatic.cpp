// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/quasistatic.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "sim/cell_volume.h"
#include "sim/relaxation_passes.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr double kDrag = 3e-7;  // settles free modes, of E a; let go where it holds anything back
constexpr double kSmallestCellVolume = 0.05;
constexpr double kEased = 2;  // times what was left over may be left over again
// Of the load that a move ends with, what one that begins anew has at first; what such a move would
// have stored without yield, over its work; and the least part of it that is made a move.
constexpr double kLittleLoad = 0.5, kBeyond = 1.2, kLeastShare = 1.0 / 64;
constexpr int kMostSplits = 3;
constexpr double kForeseen = 0.5;  // spacings that anything is taken to go on
constexpr double kFarAway = 2;     // spacings that a body without rest has gone
constexpr double kSeated = 0.01;   // spacings that a rigid piece goes in the course of things
// Spacings that a point of the work-piece may be in it where no equilibrium is found.
constexpr double kDeepest = 0.2;
// Least push, over E a^2, that the residual is measured by: about a tenth of E I / L^2 of a bar 4
// cells thick and 10 times as long (an estimate). At the first touch of a slender body the true
// push is next to nothing.
constexpr double kLeastPush = 1e-3;
// Share of the drag that stays when it is found to hold the body back.
constexpr double kLetGo = 0.1;
double largest_extent(const Aggregate& matter) {
    return matter.lattice.spacing * matter.lattice.cell_count.maxCoeff();
}

// NOTE: the tangent knows nothing of how a pressure turns with the surface. Without it a free body
// under pressure seems to gain by turning over.
bool floats_under_pressure(const Apparatus& apparatus) {
    return apparatus.grip.empty() &&
           std::any_of(apparatus.load.begin(), apparatus.load.end(),
                       [](const Load& load) { return load.force.empty() && load.pressure != 0; });
}

bool has_broken(const Aggregate& matter) {
    return std::any_of(matter.connection.begin(), matter.connection.end(), [](const auto& all) {
        return std::any_of(all.damage.begin(), all.damage.end(), [](float d) { return d >= 1; });
    });
}

}  // namespace

QuasistaticSolver::QuasistaticSolver(Aggregate& matter, const Apparatus& apparatus,
                                     const SimSettings& settings)
    : matter_(matter),
      apparatus_(apparatus),
      settings_(settings),
      lattice_(matter),
      contacts_(matter, apparatus, settings, 0),
      pushes_(apparatus, settings, 0),
      self_(matter, settings),
      body_size_(largest_extent(matter)),
      free_(matter, apparatus),
      begun_at_(matter.particle_position),
      slips_(apparatus),
      measure_(kLeastPush * matter.mean_modulus() * matter.lattice.spacing *
               matter.lattice.spacing),
      load_(apparatus.tool.size() + apparatus.grip.size()) {
    velocity_.resize(matter.particle_count());
    matter_.branch_memory.clear();
    yields_ = matter.yields();
    find_bounds();
}

void QuasistaticSolver::connections_changed(std::size_t) {
    severed_ = true;
    lattice_.connections_changed(matter_, true);
    connections_renewed();
}

// Masses are found anew.
void QuasistaticSolver::connections_renewed() {
    contacts_.connections_changed(matter_);
    pushes_.connections_changed(matter_);
    self_.connections_changed();
    free_.connections_changed();
    find_bounds();
}

void QuasistaticSolver::find_bounds() {
    lattice_bound_ = lattice_.stiffness_bound(matter_);
    coarse_.reset();
    const std::vector<float>* cells = lattice_.cells_alone();
    newton_ = cells != nullptr ? std::make_unique<Newton>(matter_, *cells) : nullptr;
    const double a = matter_.lattice.spacing;
    const double full_mass = matter_.material.density * a * a * a;
    drag_.resize(matter_.particle_count());
    const double modulus = matter_.mean_modulus();
    for (std::size_t p = 0; p < drag_.size(); ++p) {
        drag_[p] = kDrag * modulus * a * matter_.particle_mass[p] / full_mass;
    }
    foresight_.forget();
}

void QuasistaticSolver::evaluate(const Drive& to, double moved) {
    mirrored_ = lattice_.find(matter_, Flow::trial, force_);
    contacts_.add_forces(matter_, to, force_, moved);
    free_.add_loads(pushes_, to, force_);
    const bool may_lie =
        !apparatus_.tool.empty() || (settings_.self_contact && free_.are_several());
    if (!may_lie) free_.steady(pushes_, to, force_);
    add_restraint(matter_.particle_position,
                  {held_, drag_, hold_, free_.heavy_mass(), pushes_.gravity(to)}, force_);
    self_.add_forces(force_);
}

double QuasistaticSolver::push_measure(const Drive& to) const {
    return measure_.measure(pushes_.size(matter_, to),
                            [&] { return contacts_.loads(matter_, to); });
}

double QuasistaticSolver::residual_of(const Vec3Array& force, const Drive& to) const {
    const Vec3Array& f = force;
    const double sum = chunked_sum(f.size(), [&](std::size_t p) {
        return std::sqrt(f.x[p] * f.x[p] + f.y[p] * f.y[p] + f.z[p] * f.z[p]);
    });
    return sum / push_measure(to);
}

NewtonProblem QuasistaticSolver::problem_of(const Drive& to, RestingContacts::Slipping slipping) {
    NewtonProblem problem;
    problem.forces = [&](Vec3Array& force) {
        evaluate(to);
        force = force_;
    };
    problem.residual = [&](const Vec3Array& force) { return residual_of(force, to); };
    problem.tolerance = accuracy_;
    problem.held = contacts_.held_points(matter_, to, slipping);
    problem.diagonal = lattice_bound_;
    contacts_.add_stiffness(matter_, problem.diagonal);
    problem.drag.resize(drag_.size());
    for (std::size_t p = 0; p < drag_.size(); ++p) problem.drag[p] = hold_ * drag_[p];
    return problem;
}

QuasistaticSolver::Relaxation QuasistaticSolver::solve_smooth(const Drive& to) {
    const Newton::Result found =
        newton_->solve(matter_, problem_of(to, RestingContacts::Slipping::free));
    return {found.converged && mirrored_ == 0, found.steps, found.residual};
}

constexpr double kNudge = 0.02;  // spacings: the least that a body that buckles is moved
constexpr int kMostTurns = 4;
constexpr double kDriven = 0.03;  // of what drives a body that buckles may be left over
constexpr double kFinest = 1e-4;  // of the tolerance: less is never asked for
constexpr double kAstray = 0.01;  // of the way that the body has gone

// How many rounds of letting go of the drag Newton's method goes ahead.
constexpr double kSmoothHold = 1e-3;
constexpr int kLongestPause = 16;

// The drag is let go until what it holds back is no more than the residual may be, from where that
// was so in the move before. NOTE: loose pieces would fly off with what little drag that was.
QuasistaticSolver::Relaxation QuasistaticSolver::relax(const Drive& to) {
    Relaxation result;
    held_ = rest_;
    contacts_.find_candidates(matter_, to);
    self_.meet_anew();
    bool smooth = newton_ && newton_rests_ == 0 && !touches() && !floats_under_pressure(apparatus_);
    const double first = free_.are_several() ? 1 : std::exchange(enough_hold_, 1);
    for (hold_ = smooth ? kSmoothHold : first;; hold_ *= kLetGo) {
        Relaxation round;
        if (smooth) {
            const Vec3Array before = matter_.particle_position;
            round = solve_smooth(to);
            contacts_.find_candidates(matter_, to);
            self_.meet_anew();  // not what steps that were not kept have met
            if (!round.converged) {
                newton_pause_ = std::clamp(2 * newton_pause_, 1, kLongestPause);
                newton_rests_ = newton_pause_;
            } else {
                newton_pause_ = 0;
            }
            if (round.converged && free_.has_fallen(pushes_, to, start_, body_size_)) {
                return {false, result.iterations + round.iterations, round.residual, true};
            }
            if (!round.converged || touches()) {
                matter_.particle_position = before;
                smooth = false;
                hold_ = first;
            }
        }
        if (!smooth) round = settle(to);
        result = {round.converged, result.iterations + round.iterations, round.residual,
                  round.falls};
        if (!round.converged) return result;
        const Vec3Array& x = matter_.particle_position;
        const double dragged = hold_ * chunked_sum(x.size(), [&](std::size_t p) {
                                   return drag_[p] * (x.at(p) - held_.at(p)).norm();
                               });
        if (dragged <= accuracy_ * push_measure(to)) {
            if (!smooth) enough_hold_ = hold_;
            return result;
        }
        held_ = x;
    }
}

// A body that buckles is moved the way it wants to go, as far as the forces drive it there, and
// comes to rest from there. What a slender body's push leaves over may be nothing beside the push,
// and yet take it far: then less has to be left.
QuasistaticSolver::Relaxation QuasistaticSolver::relax_stably(const Drive& to,
                                                              MoveOutcome& outcome) {
    accuracy_ = settings_.tolerance;
    Relaxation result = relax(to);
    const auto again = [&](double accuracy) {
        accuracy_ = accuracy;
        const Relaxation next = relax(to);
        result = {next.converged, result.iterations + next.iterations, next.residual, next.falls};
    };
    for (int turn = 0; turn < kMostTurns && newton_ && result.converged;) {
        if (floats_under_pressure(apparatus_) || self_.presses()) break;
        NewtonProblem problem = problem_of(to, RestingContacts::Slipping::held);
        if (problem.held.empty()) break;  // what nothing bears on has nothing to give way to
        // Whether the matter itself gives way is asked, and not whether it can slide in its grips.
        for (HeldPoint& h : problem.held) {
            const Eigen::SelfAdjointEigenSolver<Mat3> ways(h.stiffness, Eigen::EigenvaluesOnly);
            h.stiffness = ways.eigenvalues().maxCoeff() * Mat3::Identity();
        }
        if (!newton_->buckles(matter_, problem)) {
            if (touches() || accuracy_ < kFinest * settings_.tolerance) break;
            const double hold = std::exchange(hold_, 0);  // the drag holds back what is left over
            evaluate(to);
            hold_ = hold;
            const Newton::Astray soft = newton_->astray(matter_, force_, begun_at_);
            if (soft.left <= kAstray * soft.gone + kNudge * kAstray * matter_.lattice.spacing)
                break;
            const Relaxation enough = result;
            const Vec3Array there = matter_.particle_position;
            again(0.1 * accuracy_);
            if (result.converged) continue;
            matter_.particle_position = there;
            result = {true, result.iterations, enough.residual};
            break;
        }
        ++turn;
        const Vec3Array way = newton_->softest_motion();
        const double longest = longest_of(way);
        const Vec3Array from = matter_.particle_position;
        const auto work_at = [&](double far) {
            matter_.particle_position = from;
            combine(1, far / longest, way, matter_.particle_position);
            evaluate(to);
            return far > 0 ? dot(force_, way) : -dot(force_, way);
        };
        const double a = matter_.lattice.spacing;
        double far = kNudge * a;
        if (work_at(-far) > work_at(far)) far = -far;
        while (std::abs(far) < a && work_at(2 * far) > 0) far *= 2;
        work_at(far);
        rest_ = matter_.particle_position;
        again(std::clamp(kDriven * residual_of(force_, to), kFinest * settings_.tolerance,
                         settings_.tolerance));
        // What falls far takes long.
        for (int more = 0; more < kMostTurns && !result.converged; ++more) {
            rest_ = matter_.particle_position;
            again(settings_.tolerance);
        }
        outcome.buckled = true;
    }
    return result;
}

// Where a move that began with next to no load has gone beyond yield: the share of it that ends
// there; else 1. NOTE: what tools do is found from their loads at both ends, and a load that is
// soon reached and stays does up to twice as much. `held` [J]: by the matter at first.
double QuasistaticSolver::share_to_yield(const Drive& from, const Drive& to, double held) {
    if (!yields_ || splits_ == kMostSplits) return 1;
    const std::vector<LoadSum> load = contacts_.loads(matter_, to);
    double before = 0, after = 0;
    for (std::size_t n = 0; n < load.size(); ++n) {
        before += load_[n].size;
        after += load[n].size;
    }
    if (before > kLittleLoad * after) return 1;
    std::vector<double> work(load.size(), 0.0);
    add_work(from, to, load_, load, work);
    const std::vector<double> idle = contacts_.stroke(matter_, from, to).idle;
    const double all = std::accumulate(work.begin(), work.end(), 0.0);
    const double air = std::accumulate(idle.begin(), idle.end(), 0.0), done = all - air;
    const double unyielding = elastic_energy() - held;  // what flows has not flowed on the books
    if (!(done > 0) || unyielding < kBeyond * done) return 1;
    const double touched = std::max(kLeastShare, done / unyielding);
    return 1 - std::clamp(done / all, 0.0, 1.0) * (1 - touched);
}

// What a try that has come to nothing met, at the positions that it came to.
std::string QuasistaticSolver::met(const Drive& to) {
    std::string text = contacts_.hardest_point(matter_, to);
    const double a = matter_.lattice.spacing;
    if (self_.presses()) {
        text += fmt::format("; the work-piece touches itself, {:.2g} spacings deep",
                            self_.sums().penetration / a);
    }
    const double way = farthest_move(matter_.particle_position, start_);
    if (pushes_.count() > 0 && way > kFarAway * a) {
        text += fmt::format("; the work-piece was on its way, {:.2g} spacings from where it lay",
                            way / a);
    }
    return text;
}

// Takes the try back. Whether another may come to more, for something that would not come to rest
// is left alone from now on.
bool QuasistaticSolver::take_back(Relaxation& tried, const Drive& to, int depth,
                                  MoveOutcome& outcome) {
    const bool given_up = !tried.converged && depth >= settings_.halving_limit;
    tried.falls = tried.falls || (given_up && begins_to_fall(to));
    int let_be = 0;
    if (given_up && !tried.falls && self_.presses()) {
        let_be = self_.let_be(kDeepest * matter_.lattice.spacing);
    }
    // What light crumbs are short of rest may be nothing beside what was let go of, or no more than
    // the last stage left over, and much beside the loads.
    const double measure = kEased * tried.residual * push_measure(to) / settings_.tolerance;
    const bool eased =
        given_up && !tried.falls && !tried.converged && measure_.ease(measure, kEased);
    if (eased) outcome.left_over = settings_.tolerance * measure;
    matter_.particle_position = start_;
    self_.take_back();
    foresight_.forget();
    const bool may_hang = !tried.converged && !tried.falls && (given_up || depth > 0);
    const int afloat = tried.falls ? free_.let_fall() : 0, hanging = may_hang ? let_hang(to) : 0;
    outcome.afloat += afloat;
    outcome.hanging += hanging;
    outcome.let_be += let_be;
    return eased || afloat + hanging + let_be > 0;
}

void QuasistaticSolver::stop(const Relaxation& tried, const Drive& to, int depth,
                             const std::string& met) const {
    if (tried.falls) {
        fail(ExitCode::stopped,
             "{}: the work-piece{} falls at {:.4g} s, for nothing holds it against gravity and "
             "loads, and equilibria have no fall: hold it, have it lie on something, or let it "
             "fall by solver = \"explicit\"",
             apparatus_.name, has_broken(matter_) ? ", which has broken," : "", to.time);
    }
    const char* advice = "raise frames or tolerance of the stage";
    if (tried.converged) {
        advice = "a cell is crushed flat: raise [mold] across, or bend and twist less";
    } else if (pushes_.count() > 0 && yields_) {
        advice =
            "if the matter flows under loads that it cannot bear, lower them; else raise frames or "
            "tolerance of the stage";
    }
    fail(ExitCode::stopped,
         "{}: no equilibrium found at {:.4g} s after {} iterations and {} halvings (residual "
         "{:.2g} of the largest push, wanted {:.2g}; {}); {}",
         apparatus_.name, to.time, tried.iterations, depth, tried.residual, settings_.tolerance,
         met, advice);
}

bool QuasistaticSolver::increment(const Drive& from, const Drive& to, int depth,
                                  MoveOutcome& outcome, Unsolved unsolved) {
    start_ = matter_.particle_position;
    const double held = yields_ ? elastic_energy() : 0;
    const double before = matter_.breaks() ? booked(from, outcome.body[0]) : 0;
    newton_rests_ = std::max(0, newton_rests_ - 1);
    contacts_.begin_move(matter_, from);
    if (contacts_.near_travel(from, to) > 0) measure_.drive();
    self_.begin_move();
    const DriveMotion motion = motion_between(apparatus_, from, to, body_size_);
    const bool released = pushes_.eases(from, to) || slips_.draws_back(motion);
    foresight_.go_on(motion, kForeseen * matter_.lattice.spacing, matter_.particle_position);
    free_.carry(from, to, start_, rest_, matter_.particle_position);
    const double seated = seat_pieces(from, to);

    const bool had_buckled = std::exchange(outcome.buckled, false);
    Relaxation found = relax_stably(to, outcome);
    const bool buckled = outcome.buckled;
    outcome.buckled = buckled || had_buckled;
    outcome.iterations += found.iterations;
    outcome.residual = found.residual;
    if (!found.converged || smallest_cell_volume(matter_) <= kSmallestCellVolume) {
        const std::string met = this->met(to);
        if (take_back(found, to, depth, outcome)) {
            return increment(from, to, depth, outcome, unsolved);
        }
        if (unsolved == Unsolved::leave) return false;
        if (found.falls || depth >= settings_.halving_limit) stop(found, to, depth, met);
        ++outcome.halvings;
        const Drive middle = drive_between(from, to, 0.5);
        increment(from, middle, depth + 1, outcome);
        increment(middle, to, depth + 1, outcome);
        return true;
    }

    if (const double share = share_to_yield(from, to, held); share < 1) {
        matter_.particle_position = start_;
        self_.take_back();
        foresight_.forget();
        ++splits_;
        const Drive middle = drive_between(from, to, share);
        increment(from, middle, depth, outcome);
        increment(middle, to, depth, outcome);
        return true;
    }

    stay(to);
    outcome.body[0].friction_work += self_.commit();
    const bool breaks = commit(outcome);
    const RestingContacts::Stroke stroke = contacts_.stroke(matter_, from, to);
    outcome.body[0].friction_work += stroke.friction;
    contacts_.commit(matter_, to);
    std::vector<LoadSum> load = contacts_.loads(matter_, to);
    std::vector<double> work(load_.size(), 0.0);
    add_work(from, to, load_, load, work);
    for (std::size_t n = 0; n < work.size(); ++n) {
        work[n] -= stroke.idle[n];
        outcome.body[0].work[n] += work[n];
        measure_.carry(load[n].size);
    }
    slips_.keep(load, work, motion, released || breaks, outcome.lost);
    load_ = std::move(load);
    pushes_.commit(matter_, to, outcome.body[0].push_work);
    if (breaks) {
        const double done = std::accumulate(work.begin(), work.end(), 0.0);
        outcome.body[0].set_free += std::max(0.0, before + done - booked(to, outcome.body[0]));
    }
    foresight_.keep(start_, motion);
    // None of these goes on as it did.
    if (buckled || breaks || seated > kSeated * matter_.lattice.spacing) foresight_.forget();
    ++outcome.increments;
    return true;
}

MoveOutcome QuasistaticSolver::advance(const Drive& from, const Drive& to) {
    MoveOutcome outcome;
    outcome.body.emplace_back(apparatus_, pushes_.count());
    pushes_.start(matter_, from);
    seats_ = true;
    const bool severed = std::exchange(severed_, false);
    const bool let_go_of = begin(from, outcome.body[0]) || severed;
    measure_.ask(std::max(pushes_.size(matter_, from), pushes_.size(matter_, to)));
    const int count = increments_between(contacts_, matter_, from, to);
    if (let_go_of) let_go(from, outcome);
    Drive before = from;
    for (int n = 1; n <= count; ++n) {
        const Drive after = n == count ? to : drive_between(from, to, double(n) / count);
        splits_ = 0;
        increment(before, after, 0, outcome);
        let_crack(after, outcome);
        before = after;
    }
    outcome.body[0].load = load_;
    outcome.body[0].after = {0, elastic_energy(),
                             contacts_.stored_energy(matter_, to) + self_.sums().stored};
    return outcome;
}

}  // namespace swage
