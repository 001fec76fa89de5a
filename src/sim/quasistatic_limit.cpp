// SPDX-License-Identifier: GPL-3.0-or-later
// How the quasi-static solver comes to a limit from below: what goes beyond is taken back before
// anything of it is committed, and what does not is kept. Where to try next is by false position
// with the weights of the Illinois rule, and by halves where that is slow.
#include <algorithm>
#include <cmath>

#include "sim/quasistatic.h"

namespace swage {

namespace {

// Shares of a limit: what is aimed at, from where on it is met at once, and where it is no jump.
constexpr double kAim = 0.9995, kMet = 0.999, kNear = 0.995;
constexpr int kTriesToMeet = 12, kMostTries = 60;
constexpr double kLeastWay = 1e-12;   // of the way that was too far
constexpr double kLeastShare = 1e-3;  // of what is left of it, for a try

}  // namespace

Drive QuasistaticSolver::between(const Drive& from, const Drive& to, double s) const {
    return way_ != nullptr ? (*way_)((1 - s) * from.time + s * to.time)
                           : drive_between(from, to, s);
}

double QuasistaticSolver::borne_of(std::size_t number, const std::vector<PartSum>& load,
                                   const Drive& now) const {
    const LoadLimit& limit = apparatus_.limit[number];
    return limit.borne(load[limit.part].force, load[limit.part].torque,
                       pose_of(now, limit.part, apparatus_.tool.size()));
}

QuasistaticSolver::Reach QuasistaticSolver::reach_of(const std::vector<PartSum>& load,
                                                     const Drive& now) const {
    Reach most;
    for (std::size_t l = 0; l < apparatus_.limit.size(); ++l) {
        const double share = borne_of(l, load, now) / apparatus_.limit[l].most;
        if (l == 0 || share > most.share) most = {l, share};
    }
    return most;
}

// A try that has converged. Of one where nothing moves there is nothing to take back.
bool QuasistaticSolver::goes_beyond(const StaticMove& move) {
    if (!is_limited() || !(move.to.time > move.from.time)) return false;
    const Reach reach = reach_of(forces_.contacts.loads(matter_, move.to), move.to);
    if (reach.share <= 1) return false;
    beyond_ = {move.to, reach};
    return true;
}

// The move has ended in `stands_`.
void QuasistaticSolver::come_to_stop(MoveOutcome& outcome) {
    const Reach reach = reach_of(load_, stands_);
    if (reach.share < kMet) return;
    outcome.stop = {reach.limit, stands_, borne_of(reach.limit, load_, stands_)};
    has_stopped_ = true;
}

// From where the matter stands, within all limits, toward where a try went beyond one.
void QuasistaticSolver::approach(MoveOutcome& outcome) {
    const double least = kLeastWay * (beyond_.at.time - stands_.time);
    double below = reach_of(load_, stands_).share - kAim, above = beyond_.reach.share - kAim;
    double width = beyond_.at.time - stands_.time;
    int side = 0, slow = 0;
    for (int tries = 0; tries < kMostTries; ++tries) {
        const double met = tries < kTriesToMeet ? kMet : kNear;
        if (reach_of(load_, stands_).share >= met) break;
        double s = std::clamp(below / (below - above), kLeastShare, 1 - kLeastShare);
        if (slow > 1) s = 0.5;
        const Drive from = stands_, middle = between(stands_, beyond_.at, s);
        if (!(middle.time - from.time > least && beyond_.at.time - middle.time > least)) break;
        splits_ = 0;
        const bool arrived = increment(from, middle, 0, outcome);
        // Where it did not, a part of the way may have been gone.
        if (stands_.time > from.time) let_crack(stands_, outcome);
        if (arrived) {
            if (side < 0) above /= 2;
            side = -1;
        } else {
            above = beyond_.reach.share - kAim;
            if (side > 0) below /= 2;
            side = 1;
        }
        if (side < 0 || stands_.time > from.time) below = reach_of(load_, stands_).share - kAim;
        const double left = beyond_.at.time - stands_.time;
        slow = left > 0.5 * width ? slow + 1 : 0;
        width = left;
    }
    const bool jumps = reach_of(load_, stands_).share < kNear;
    const std::size_t limit = jumps ? beyond_.reach.limit : reach_of(load_, stands_).limit;
    outcome.stop = {limit, stands_, borne_of(limit, load_, stands_)};
    if (jumps) outcome.stop->beyond = beyond_.reach.share * apparatus_.limit[limit].most;
    has_stopped_ = true;
}

}  // namespace swage
