// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/quasistatic.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "sim/cell_volume.h"

namespace swage {

namespace {

constexpr double kSmallestCellVolume = 0.05;
constexpr double kEased = 2;  // times what was left over may be left over again
// Of the load that a move ends with, what one that begins anew has at first; what such a move would
// have stored without yield, over its work; and the least part of it that is made a move.
constexpr double kLittleLoad = 0.5, kBeyond = 1.2, kLeastShare = 1.0 / 64;
constexpr int kMostSplits = 3;
constexpr double kForeseen = 0.5;  // spacings that anything is taken to go on
constexpr double kSeated = 0.01;   // spacings that a rigid piece goes in the course of things
// Spacings that a point of the work-piece may be in it where no equilibrium is found.
constexpr double kDeepest = 0.2;

// Nothing is idle by more than it seems to have done: what stands does nothing. What is left of
// that is so of all work alike, also that of `loads`, whose part of it stays in the remainder.
void take_idle(const std::vector<double>& idle, const std::vector<double>& loads,
               std::vector<double>& work) {
    double size = 0, left = 0;
    for (const auto* all : {&loads, &std::as_const(work)}) {
        for (double done : *all) size += std::abs(done);
    }
    if (!(size > 0)) return;
    std::vector<double> own(work.size());
    for (std::size_t n = 0; n < work.size(); ++n) {
        own[n] = std::clamp(idle[n], -std::abs(work[n]), std::abs(work[n]));
        left += idle[n] - own[n];
    }
    left = std::clamp(left, -size, size);
    for (std::size_t n = 0; n < work.size(); ++n) {
        work[n] -= own[n] + std::abs(work[n]) / size * left;
    }
}

}  // namespace

QuasistaticSolver::QuasistaticSolver(Aggregate& matter, const Apparatus& apparatus,
                                     const SimSettings& settings)
    : matter_(matter),
      apparatus_(apparatus),
      settings_(settings),
      forces_(matter, apparatus, settings),
      search_(forces_, settings),
      slips_(apparatus),
      load_(apparatus.tool.size() + apparatus.grip.size()) {}

double QuasistaticSolver::connections_changed(std::size_t, const Drive& now) {
    severed_ = true;
    forces_.lattice.connections_changed(matter_, true);
    const double held = begun_ ? forces_.stored(now).contact : 0;
    connections_renewed();
    return begun_ ? held - forces_.stored(now).contact : 0;
}

void QuasistaticSolver::connections_renewed() {
    forces_.connections_changed();
    search_.connections_changed(forces_);
    foresight_.forget();
}

MoveOutcome QuasistaticSolver::advance(const Drive& from, const Drive& to, const DriveAt& way) {
    MoveOutcome outcome;
    BodyOutcome& body = outcome.body.emplace_back(apparatus_, forces_.pushes.count());
    forces_.pushes.start(matter_, from);
    seats_ = true;
    way_ = way ? &way : nullptr;
    stands_ = from;
    try {
        go(from, to, outcome);
    } catch (const Error& error) {
        if (error.code() != ExitCode::stopped) throw;
        outcome.given_up = {error, stands_};
    }
    body.part = load_;
    body.after = forces_.stored(outcome.end(to));
    return outcome;
}

void QuasistaticSolver::go(const Drive& from, const Drive& to, MoveOutcome& outcome) {
    const bool begins = !begun_, severed = std::exchange(severed_, false);
    const bool let_go_of = begin(from, outcome.body[0]) || severed;
    forces_.measure.ask(
        std::max(forces_.pushes.size(matter_, from), forces_.pushes.size(matter_, to)));
    const int count = increments_between(forces_.contacts, matter_, from, to);
    if (let_go_of) {
        let_go(from, outcome);
    } else if (begins && is_limited()) {
        // What is borne before anything moves may be beyond a limit.
        increment(from, from, settings_.halving_limit, outcome, Unsolved::leave);
    }
    if (is_limited()) come_to_stop(outcome);
    Drive before = from;
    for (int n = 1; n <= count && !outcome.stop; ++n) {
        const Drive after = n == count ? to : between(from, to, double(n) / count);
        splits_ = 0;
        if (increment(before, after, 0, outcome)) {
            let_crack(after, outcome);
            if (is_limited()) come_to_stop(outcome);
        } else {
            approach(outcome);
        }
        before = after;
    }
}

bool QuasistaticSolver::increment(const Drive& from, const Drive& to, int depth,
                                  MoveOutcome& outcome, Unsolved unsolved) {
    StaticMove move = begin_move(from, to, depth, outcome.body[0]);
    move.let_go = unsolved == Unsolved::leave;
    const bool goes_off =
        forces_.contacts.stand_still(matter_, from, to) && forces_.is_pushed_off(to);
    Relaxation found = goes_off ? Relaxation{.falls = true} : search_.find(forces_, move);
    outcome.iterations += found.iterations;
    if (!found.converged || smallest_cell_volume(matter_) <= kSmallestCellVolume) {
        const std::string met = this->met(move);
        if (take_back(found, move, outcome)) return increment(from, to, depth, outcome, unsolved);
        if (unsolved == Unsolved::leave) return false;
        if (found.falls || depth >= settings_.halving_limit) stop(found, move, met);
        ++outcome.halvings;
        const Drive middle = between(from, to, 0.5);
        return increment(from, middle, depth + 1, outcome) &&
               increment(middle, to, depth + 1, outcome);
    }
    if (goes_beyond(move)) {
        put_back(move);
        return false;
    }
    if (const double share = share_to_yield(move); share < 1) {
        put_back(move);
        ++splits_;
        const Drive middle = between(from, to, share);
        return increment(from, middle, depth, outcome) && increment(middle, to, depth, outcome);
    }
    outcome.residual = std::max(outcome.residual, found.residual);
    outcome.buckled = outcome.buckled || found.buckled;
    keep(move, found.buckled, outcome);
    return true;
}

StaticMove QuasistaticSolver::begin_move(const Drive& from, const Drive& to, int depth,
                                         const BodyOutcome& outcome) {
    StaticMove move{from, to, depth, matter_.particle_position};
    if (matter_.yields()) move.elastic = elastic_energy();
    if (matter_.breaks()) move.booked = booked(from, outcome);
    forces_.contacts.begin_move(matter_, from);
    if (!forces_.contacts.stand_still(matter_, from, to)) forces_.measure.drive();
    forces_.self.begin_move();
    move.motion = motion_between(apparatus_, from, to, forces_.extent());
    move.released = forces_.pushes.eases(from, to) || slips_.draws_back(move.motion);
    foresight_.go_on(move.motion, kForeseen * matter_.lattice.spacing, matter_.particle_position);
    forces_.free.carry(from, to, move.start, move.rest, matter_.particle_position);
    move.seated = seat_pieces(move);
    return move;
}

// Returns what the work-piece no longer holds there [J].
double QuasistaticSolver::put_back(const StaticMove& move) {
    matter_.particle_position = move.start;
    if (!move.history.empty()) matter_.cell_history = move.history;
    foresight_.forget();
    return forces_.self.take_back();
}

// Takes the try back. Whether another may come to more, for something that would not come to rest
// is left alone from now on.
bool QuasistaticSolver::take_back(Relaxation& tried, const StaticMove& move, MoveOutcome& outcome) {
    const bool given_up = !tried.converged && move.depth >= settings_.halving_limit;
    tried.falls = tried.falls || (given_up && forces_.begins_to_fall(move.to));
    int let_be = 0;
    if (given_up && !tried.falls && forces_.self.presses()) {
        let_be = forces_.self.let_be(kDeepest * matter_.lattice.spacing);
    }
    // What light crumbs are short of rest may be nothing beside what was let go of, or no more than
    // the last stage left over, and much beside the loads.
    const double measure =
        kEased * tried.residual * forces_.push_measure(move.to) / settings_.tolerance;
    const bool eased =
        given_up && !tried.falls && !tried.converged && forces_.measure.ease(measure, kEased);
    if (eased) outcome.left_over = settings_.tolerance * measure;
    outcome.body[0].set_free += put_back(move);
    const bool may_hang = !tried.converged && !tried.falls && (given_up || move.depth > 0);
    const int afloat = tried.falls ? forces_.free.let_fall(forces_.pushes) : 0,
              hanging = may_hang ? forces_.let_hang(move.to) : 0;
    outcome.afloat += afloat;
    outcome.hanging += hanging;
    outcome.let_be += let_be;
    return eased || afloat + hanging + let_be > 0;
}

// Where a move that began with next to no load has gone beyond yield: the share of it that ends
// there; else 1. NOTE: what tools do is found from their loads at both ends, and a load that is
// soon reached and stays does up to twice as much.
double QuasistaticSolver::share_to_yield(const StaticMove& move) {
    if (!matter_.yields() || splits_ == kMostSplits) return 1;
    const std::vector<PartSum> load = forces_.contacts.loads(matter_, move.to);
    double before = 0, after = 0;
    for (std::size_t n = 0; n < load.size(); ++n) {
        before += load_[n].size;
        after += load[n].size;
    }
    if (before > kLittleLoad * after) return 1;
    std::vector<double> work(load.size(), 0.0);
    add_work(move.from, move.to, load_, load, work);
    const double all = std::accumulate(work.begin(), work.end(), 0.0);
    const double done = all - forces_.contacts.air(matter_, move.from, move.to);
    // What flows has not flowed on the books.
    const double unyielding = elastic_energy() - move.elastic;
    if (!(done > 0) || unyielding < kBeyond * done) return 1;
    const double touched = std::max(kLeastShare, done / unyielding);
    return 1 - std::clamp(done / all, 0.0, 1.0) * (1 - touched);
}

void QuasistaticSolver::keep(const StaticMove& move, bool buckled, MoveOutcome& outcome) {
    BodyOutcome& body = outcome.body[0];
    stay(move);
    body.friction_work += forces_.self.commit();
    const bool breaks = commit(body);
    const RestingContacts::Stroke stroke = forces_.contacts.stroke(matter_, move.from, move.to);
    body.friction_work += stroke.friction;
    forces_.contacts.commit(matter_, move.to);
    for (const int tool : forces_.contacts.take_pierced()) {
        const std::string& name = apparatus_.tool[std::size_t(tool)].name;
        if (std::ranges::find(outcome.pierced, name) == outcome.pierced.end()) {
            outcome.pierced.push_back(name);
        }
    }
    std::vector<PartSum> load = forces_.contacts.loads(matter_, move.to);
    std::vector<double> work(load_.size(), 0.0);
    add_work(move.from, move.to, load_, load, work);
    // It judges what the trapezoid rule says.
    slips_.keep(load, work, move.motion, move.released || breaks, outcome.lost);
    std::vector<double> pushed(body.load_work.size(), 0.0);
    forces_.pushes.commit(matter_, move.to, pushed);
    take_idle(stroke.idle, pushed, work);
    for (std::size_t n = 0; n < pushed.size(); ++n) body.load_work[n] += pushed[n];
    for (std::size_t n = 0; n < work.size(); ++n) {
        body.work[n] += work[n];
    }
    outcome.rounded = std::max(outcome.rounded, forces_.rounded(move.to));
    forces_.measure.carry(load);
    load_ = std::move(load);
    if (breaks) {
        const double done = std::accumulate(work.begin(), work.end(), 0.0);
        body.set_free += std::max(0.0, move.booked + done - booked(move.to, body));
    }
    foresight_.keep(move.start, move.motion);
    // None of these goes on as it did.
    if (buckled || breaks || move.seated > kSeated * matter_.lattice.spacing) foresight_.forget();
    ++outcome.increments;
    stands_ = move.to;
}

bool QuasistaticSolver::commit(BodyOutcome& outcome) {
    const Committed lost = forces_.lattice.commit(matter_);
    outcome.plastic_work += lost.plastic;
    outcome.fracture_work += lost.fracture;
    outcome.broken += lost.broken;
    if (lost.broken > 0) {
        connections_renewed();
    } else if (lost.plastic > 0) {
        forces_.find_bound();
    }
    return lost.fracture > 0;
}

}  // namespace swage
