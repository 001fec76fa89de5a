// SPDX-License-Identifier: GPL-3.0-or-later
// What the quasi-static solver reads from how the drive moves.
#include <algorithm>
#include <cmath>

#include "sim/quasistatic.h"

namespace swage {

namespace {

// Shares of the most that a tool has carried: loaded, and not any more.
constexpr double kLoadedShare = 0.3, kUnloadedShare = 0.1;

}  // namespace

int increments_between(const ContactSet& contacts, const Aggregate& matter, const Drive& from,
                       const Drive& to) {
    const double travel = contacts.travel(matter, from, to);
    return std::max(1, static_cast<int>(std::ceil(travel / matter.lattice.spacing)));
}

// How the drive moves, as one vector: translations; turns and strengths times the body's size.
std::vector<double> QuasistaticSolver::motion_of(const Drive& from, const Drive& to) const {
    std::vector<double> motion;
    const auto add = [&](const std::vector<Pose>& a, const std::vector<Pose>& b) {
        for (std::size_t n = 0; n < a.size(); ++n) {
            const Vec3 way = b[n].translation - a[n].translation;
            const Vec3 turn = body_size_ * turn_between(a[n], b[n]);
            motion.insert(motion.end(), {way.x(), way.y(), way.z(), turn.x(), turn.y(), turn.z()});
        }
    };
    add(from.world_from_tool, to.world_from_tool);
    add(from.world_from_grip, to.world_from_grip);
    for (std::size_t l = 0; l < apparatus_.load.size(); ++l) {
        motion.push_back(body_size_ * (to.load_strength[l] - from.load_strength[l]));
    }
    motion.push_back(body_size_ * (to.gravity_strength - from.gravity_strength));
    return motion;
}

void QuasistaticSolver::find_carriers() {
    constexpr int kNone = -1, kSeveral = -2;
    carrier_.clear();
    pieces_ = find_pieces(matter_);
    std::vector<int> of_piece(static_cast<std::size_t>(pieces_.count), kNone);
    for (std::size_t g = 0; g < apparatus_.grip.size(); ++g) {
        const Grip& grip = apparatus_.grip[g];
        const int carries = grip.hold == Vec3::Ones() ? static_cast<int>(g) : kSeveral;
        for (int point : grip.point) {
            const auto by = matter_.surface.carriers(static_cast<std::size_t>(point));
            for (int c = 0; c < 8; ++c) {
                if (by.weight[c] == 0) continue;
                int& of = of_piece[pieces_.particle_piece[by.corner[c]]];
                of = of == kNone || of == carries ? carries : kSeveral;
            }
        }
    }
    gripped_.clear();
    for (int by : of_piece) gripped_.push_back(by != kNone);
    if (pieces_.count < 2) return;
    for (int piece : pieces_.particle_piece) carrier_.push_back(std::max(kNone, of_piece[piece]));
}

// What a single grip holds goes where that goes, whole. NOTE: else the drag, which is let go only
// until it holds back no more than the residual may be, pulls at pieces that are drawn away.
void QuasistaticSolver::carry_pieces(const Drive& from, const Drive& to) {
    rest_ = start_;
    if (carrier_.empty()) return;
    std::vector<Pose> change;
    for (std::size_t g = 0; g < to.world_from_grip.size(); ++g) {
        change.push_back(to.world_from_grip[g] * from.world_from_grip[g].inverse());
    }
    for (std::size_t p = 0; p < carrier_.size(); ++p) {
        if (carrier_[p] < 0) continue;
        rest_.set(p, change[static_cast<std::size_t>(carrier_[p])] * start_.at(p));
        matter_.particle_position.set(p, rest_.at(p));
    }
}

// Goes on as in the move before, by at most half a spacing. Nothing is foreseen where the drive
// starts, stops or turns back.
void QuasistaticSolver::predict(const std::vector<double>& motion) {
    if (previous_motion_.empty()) return;
    double along = 0, square = 0;
    for (std::size_t n = 0; n < motion.size(); ++n) {
        along += motion[n] * previous_motion_[n];
        square += previous_motion_[n] * previous_motion_[n];
    }
    if (!(along > 0)) return;
    const double most = 0.5 * matter_.lattice.spacing, ratio = along / square;
    const auto extrapolate = [&](std::vector<double>& now, const std::vector<double>& before) {
        for (std::size_t p = 0; p < now.size(); ++p) {
            now[p] += std::clamp(ratio * (now[p] - before[p]), -most, most);
        }
    };
    Vec3Array& x = matter_.particle_position;
    extrapolate(x.x, previous_.x);
    extrapolate(x.y, previous_.y);
    extrapolate(x.z, previous_.z);
}

// Whether any tool moves otherwise than it did when it last pressed, or a load is taken off.
bool QuasistaticSolver::draws_back(const Drive& from, const Drive& to,
                                   const std::vector<double>& motion) const {
    if (pushes_.eases(from, to)) return true;
    for (std::size_t t = 0; t < apparatus_.tool.size(); ++t) {
        double along = 0, now = 0, then = 0;
        for (std::size_t n = 6 * t; n < 6 * t + 6; ++n) {
            along += motion[n] * pressing_motion_[n];
            now += motion[n] * motion[n];
            then += pressing_motion_[n] * pressing_motion_[n];
        }
        if (now > 0 && then > 0 && along < 0.1 * std::sqrt(now * then)) return true;
    }
    return false;
}

// A tool that loses its load while none draws back has lost the work-piece.
void QuasistaticSolver::check_slip(const std::vector<LoadSum>& after, MoveOutcome& outcome) {
    for (std::size_t t = 0; t < apparatus_.tool.size(); ++t) {
        if (after[t].size > kLoadedShare * most_load_[t]) carries_[t] = true;
        if (!carries_[t] || after[t].size > kUnloadedShare * most_load_[t]) continue;
        carries_[t] = false;
        outcome.lost.push_back(apparatus_.tool[t].name);
    }
}

}  // namespace swage
