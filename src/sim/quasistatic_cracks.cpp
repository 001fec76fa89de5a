// SPDX-License-Identifier: GPL-3.0-or-later
// What the quasi-static solver does when matter breaks, is cut or is let go.

#include "base/error.h"
#include "sim/quasistatic.h"

namespace swage {

namespace {

constexpr double kRoundOff = 1e-20;  // of E a^3: what a body at rest holds

}  // namespace

// What the matter holds and took, less what loads have put in: at a standing drive it only changes
// by what is set free.
double QuasistaticSolver::booked(const Drive& now, const BodyOutcome& outcome) {
    double pushed = 0;
    for (double work : outcome.load_work) pushed += work;
    return elastic_energy() + forces_.contacts.stored_energy(matter_, now) +
           forces_.self.sums().stored + outcome.lost() - pushed;
}

// Cracks run on, round by round, until everything stands at this drive: in each the cells that are
// most strained beyond their strength turn into springs, or where there are none what was bent too
// far breaks, and all come to rest again.
void QuasistaticSolver::let_crack(const Drive& to, MoveOutcome& outcome) {
    if (!matter_.breaks()) return;
    BodyOutcome& body = outcome.body[0];
    LatticeForces& lattice = forces_.lattice;
    for (;;) {
        const double before = booked(to, body) + body.set_free;
        const Cracked cracked = lattice.crack(matter_);
        Committed snapped;
        if (cracked.cells == 0 && lattice.may_snap()) snapped = lattice.snap(matter_);
        if (cracked.cells == 0 && snapped.broken == 0) return;
        connections_renewed();
        slips_.forget();
        body.fracture_work += cracked.lost + snapped.fracture;
        body.broken += snapped.broken;
        const auto book = [&] { body.set_free = before - booked(to, body); };
        try {
            increment(to, to, settings_.halving_limit, outcome);
        } catch (const Error&) {
            book();
            throw;
        }
        book();
    }
}

// The books of a stage begin. Whether what held the body before it does so no more.
bool QuasistaticSolver::begin(const Drive& from, BodyOutcome& outcome) {
    if (begun_) return false;
    begun_ = true;
    forces_.self.presses();
    forces_.contacts.begin_move(matter_, from);
    forces_.contacts.find_candidates(matter_, from);
    outcome.before = forces_.stored(from);
    const double a = matter_.lattice.spacing;
    if (outcome.before.sum() < kRoundOff * matter_.mean_modulus() * a * a * a) return false;
    const double left = forces_.find_at_rest(from) / settings_.tolerance;
    forces_.measure.let_go(left * forces_.push_measure(from));
    return left > 1;
}

// What was cut, or lost its grips, comes to rest before anything moves, so that what it lets go of
// is not taken for an error. NOTE: where there is no rest the move goes on without; then it is.
void QuasistaticSolver::let_go(const Drive& from, MoveOutcome& outcome) {
    BodyOutcome& body = outcome.body[0];
    slips_.forget();
    const double before = booked(from, body) + body.set_free;
    forces_.measure.let_go(forces_.find_at_rest(from) * forces_.push_measure(from));
    if (!increment(from, from, settings_.halving_limit, outcome, Unsolved::leave)) return;
    body.set_free = before - booked(from, body);
}

}  // namespace swage
