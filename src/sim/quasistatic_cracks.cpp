// SPDX-License-Identifier: GPL-3.0-or-later
// What the quasi-static solver does when matter breaks.
#include <algorithm>

#include "sim/quasistatic.h"

namespace swage {

bool QuasistaticSolver::commit(MoveOutcome& outcome) {
    const Committed lost = lattice_.commit(matter_);
    outcome.body[0].plastic_work += lost.plastic;
    outcome.body[0].fracture_work += lost.fracture;
    outcome.body[0].broken += lost.broken;
    if (lost.broken > 0) {
        connections_changed();
    } else if (lost.plastic > 0) {
        lattice_bound_ = lattice_.stiffness_bound(matter_);
    }
    return lost.fracture > 0;
}

// Cracks run on, round by round, until everything stands at this drive: in each the cells that are
// most strained beyond their strength turn into springs, or where there are none what was bent too
// far breaks, and all come to rest again.
void QuasistaticSolver::let_crack(const Drive& to, MoveOutcome& outcome) {
    if (!matter_.material.breaks()) return;
    // What the matter holds and took, less what loads have put in.
    const auto booked = [&] {
        double pushed = 0;
        for (double work : outcome.body[0].push_work) pushed += work;
        return elastic_energy() + contacts_.stored_energy(matter_, to) + self_.sums().stored +
               outcome.body[0].fracture_work + outcome.body[0].plastic_work - pushed;
    };
    for (;;) {
        const double before = booked();
        const Cracked cracked = lattice_.crack(matter_);
        Committed snapped;
        if (cracked.cells == 0 && lattice_.may_snap(matter_)) snapped = lattice_.snap(matter_);
        if (cracked.cells == 0 && snapped.broken == 0) return;
        connections_changed();
        std::fill(carries_.begin(), carries_.end(), false);
        outcome.body[0].fracture_work += cracked.lost + snapped.fracture;
        outcome.body[0].broken += snapped.broken;
        increment(to, to, settings_.halving_limit, outcome);
        outcome.body[0].set_free += before - booked();
    }
}

}  // namespace swage
