// SPDX-License-Identifier: GPL-3.0-or-later
// What the quasi-static solver does when matter breaks, is cut or is let go.

#include "sim/quasistatic.h"

namespace swage {

namespace {

constexpr double kRoundOff = 1e-20;  // of E a^3: what a body at rest holds

}  // namespace

bool QuasistaticSolver::commit(MoveOutcome& outcome) {
    const Committed lost = lattice_.commit(matter_);
    outcome.body[0].plastic_work += lost.plastic;
    outcome.body[0].fracture_work += lost.fracture;
    outcome.body[0].broken += lost.broken;
    if (lost.broken > 0) {
        connections_renewed();
    } else if (lost.plastic > 0) {
        lattice_bound_ = lattice_.stiffness_bound(matter_);
    }
    return lost.fracture > 0;
}

// What the matter holds and took, less what loads have put in: at a standing drive it only changes
// by what is set free.
double QuasistaticSolver::booked(const Drive& now, const BodyOutcome& outcome) {
    double pushed = 0;
    for (double work : outcome.push_work) pushed += work;
    return elastic_energy() + contacts_.stored_energy(matter_, now) + self_.sums().stored +
           outcome.lost() - pushed;
}

// Cracks run on, round by round, until everything stands at this drive: in each the cells that are
// most strained beyond their strength turn into springs, or where there are none what was bent too
// far breaks, and all come to rest again.
void QuasistaticSolver::let_crack(const Drive& to, MoveOutcome& outcome) {
    if (!matter_.breaks()) return;
    for (;;) {
        const double before = booked(to, outcome.body[0]) + outcome.body[0].set_free;
        const Cracked cracked = lattice_.crack(matter_);
        Committed snapped;
        if (cracked.cells == 0 && lattice_.may_snap()) snapped = lattice_.snap(matter_);
        if (cracked.cells == 0 && snapped.broken == 0) return;
        connections_renewed();
        slips_.forget();
        outcome.body[0].fracture_work += cracked.lost + snapped.fracture;
        outcome.body[0].broken += snapped.broken;
        increment(to, to, settings_.halving_limit, outcome);
        outcome.body[0].set_free = before - booked(to, outcome.body[0]);
    }
}

// The books of a stage begin. Whether what held the body before it does so no more.
bool QuasistaticSolver::begin(const Drive& from, BodyOutcome& outcome) {
    if (begun_) return false;
    begun_ = true;
    self_.presses();
    contacts_.begin_move(matter_, from);
    contacts_.find_candidates(matter_, from);
    outcome.before = {0, elastic_energy(),
                      contacts_.stored_energy(matter_, from) + self_.sums().stored};
    const double a = matter_.lattice.spacing;
    if (outcome.before.sum() < kRoundOff * matter_.mean_modulus() * a * a * a) return false;
    held_ = matter_.particle_position;
    evaluate(from);
    const double left = residual_of(force_, from) / settings_.tolerance;
    measure_.let_go(left * push_measure(from));
    return left > 1;
}

// What was cut, or lost its grips, comes to rest before anything moves, so that what it lets go of
// is not taken for an error. NOTE: where there is no rest the move goes on without; then it is.
void QuasistaticSolver::let_go(const Drive& from, MoveOutcome& outcome) {
    slips_.forget();
    const double before = booked(from, outcome.body[0]) + outcome.body[0].set_free;
    held_ = matter_.particle_position;
    evaluate(from);
    measure_.let_go(residual_of(force_, from) * push_measure(from));
    if (!increment(from, from, settings_.halving_limit, outcome, Unsolved::leave)) return;
    outcome.body[0].set_free = before - booked(from, outcome.body[0]);
}

}  // namespace swage
