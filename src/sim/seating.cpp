// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method in the six numbers of a rigid body, in a trust region, with a drag that keeps the
// way in it. What the body touches leaves it some of them at first, and a way along these that is
// long beside the depth of a contact leaves the contact, for surfaces are round: from its end the
// body goes back by what it touches there alone, and only then is it asked whether the way was too
// long. It is where the body is driven back by more than half of what drove it.
#include "sim/seating.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "sim/vector_sums.h"

namespace swage {

namespace {

using Motion = Eigen::Matrix<double, 6, 1>;  // and its forces: turns times the radius [m], [N]
using Stiffness = Eigen::Matrix<double, 6, 6>;

constexpr int kMostMoves = 2000;
constexpr int kMostCuts = 12;
constexpr double kCut = 0.25;
constexpr int kMostReturns = 6;
constexpr double kFirstWay = 0.01, kLongestWay = 0.2;  // spacings
constexpr double kListed = 0.45;                       // that candidates are good for
constexpr double kMoreDrag = 4;
constexpr int kMostDrags = 100;
// Of the stiffness of what is touched: makes what that leaves free stay in returns.
constexpr double kStay = 1e-3;
constexpr double kLighter = 10;  // from one heaviness of the loads to the next

struct Place {
    Pose pose;
    Motion push = Motion::Zero();
};

class RigidPiece {
  public:
    RigidPiece(Aggregate& matter, const std::vector<ParticleId>& piece, const SeatProblem& problem)
        : matter_(matter),
          piece_(piece),
          problem_(problem),
          from_(matter.particle_position),
          is_part_(matter.particle_count(), 0) {
        for (ParticleId p : piece) centre_ += from_.at(p) / double(piece.size());
        double squares = 0, largest = 0;
        for (ParticleId p : piece) {
            const double square = (from_.at(p) - centre_).squaredNorm();
            squares += square / double(piece.size());
            largest = std::max(largest, square);
            is_part_[p] = 1;
        }
        radius_ = std::max(std::sqrt(squares), 0.5 * matter.lattice.spacing);
        longest_ = 1 + std::sqrt(largest) / radius_;
    }

    bool settle(double heavy, Place& now);

    void put_back() {
        for (ParticleId p : piece_) matter_.particle_position.set(p, from_.at(p));
        problem_.look_around();
    }

  private:
    void put(const Pose& pose) {
        for (ParticleId p : piece_) {
            matter_.particle_position.set(
                p, centre_ + pose.translation + pose.turn(from_.at(p) - centre_));
        }
    }
    Place moved(const Place& from, const Motion& way, double heavy) {
        const Vec3 turn = way.tail<3>() / radius_;
        const Pose pose{(turn_by(turn) * from.pose.rotation).normalized(),
                        from.pose.translation + way.head<3>()};
        return {pose, push_at(pose, heavy)};
    }
    Motion push_at(const Pose& pose, double heavy);
    Stiffness stiffness_at(const Pose& pose);
    void go_back(double drag, double heavy, Place& place, Motion& way);

    Vec3 arm(const Pose& pose, const Vec3& at) const {
        return (at - centre_ - pose.translation) / radius_;
    }
    // That any particle goes, at most [m].
    double longest(const Motion& way) const { return longest_ * way.norm(); }

    Aggregate& matter_;
    const std::vector<ParticleId>& piece_;
    const SeatProblem& problem_;
    const Vec3Array from_;
    std::vector<char> is_part_;
    Vec3 centre_ = Vec3::Zero();
    double radius_ = 0, longest_ = 0;
    Vec3Array force_;
};

Motion RigidPiece::push_at(const Pose& pose, double heavy) {
    put(pose);
    set_zero(matter_.particle_count(), force_);
    problem_.add_loads(force_);
    for (auto* f : {&force_.x, &force_.y, &force_.z}) {
        for (double& one : *f) one *= heavy;
    }
    problem_.add_contacts(force_);
    Motion push = Motion::Zero();
    for (ParticleId p : piece_) {
        const Vec3 f = force_.at(p);
        push.head<3>() += f;
        push.tail<3>() += arm(pose, matter_.particle_position.at(p)).cross(f);
    }
    return push;
}

Stiffness RigidPiece::stiffness_at(const Pose& pose) {
    put(pose);
    Stiffness stiffness = Stiffness::Zero();
    for (const HeldPoint& held : problem_.held()) {
        if (!is_part_[held.corner[0]]) continue;
        Vec3 at = Vec3::Zero();
        for (int c = 0; c < 8; ++c) {
            at += held.weight[c] * matter_.particle_position.at(held.corner[c]);
        }
        Eigen::Matrix<double, 3, 6> motion;
        motion << Mat3::Identity(), -cross_matrix(arm(pose, at));
        stiffness += motion.transpose() * held.stiffness * motion;
    }
    return stiffness;
}

Motion solve(const Stiffness& stiffness, double drag, const Motion& push) {
    return (stiffness + drag * Stiffness::Identity()).partialPivLu().solve(push);
}

// Back from where a way has left what is touched, or gone into it, while that brings more balance.
void RigidPiece::go_back(double drag, double heavy, Place& place, Motion& way) {
    const double most = 2 * way.norm();
    for (int n = 0; n < kMostReturns; ++n) {
        const Stiffness touched = stiffness_at(place.pose);
        const double stay = kStay * touched.trace() / 6;
        if (stay <= drag) return;
        const Motion back = solve(touched, stay, place.push);
        if (!((way + back).norm() <= most)) return;
        const Place next = moved(place, back, heavy);
        if (!(next.push.norm() <= place.push.norm())) return;
        const bool is_there = next.push.norm() > 0.5 * place.push.norm();
        place = next;
        way += back;
        if (is_there) return;
    }
}

// Whether there is a balance near `now`, with the loads so heavy.
bool RigidPiece::settle(double heavy, Place& now) {
    const double a = matter_.lattice.spacing;
    const double least_drag = problem_.drag * double(piece_.size());
    now.push = push_at(now.pose, heavy);
    double trust = kFirstWay * a, since_listed = 0;
    for (int move = 0; move < kMostMoves; ++move) {
        const double left = now.push.head<3>().norm() + now.push.tail<3>().norm();
        if (left <= heavy * problem_.enough) {
            put(now.pose);
            return true;
        }
        if (!(now.pose.translation.norm() <= problem_.reach)) return false;
        const Stiffness touched = stiffness_at(now.pose);
        Motion whole;
        double drag = least_drag;
        const auto leads_down = [&] {
            whole = solve(touched, drag, now.push);
            return longest(whole) <= trust && now.push.dot(whole) > 0;
        };
        int tries = 0;
        for (; !leads_down(); drag *= kMoreDrag) {
            if (++tries == kMostDrags) return false;  // no way is short enough, or no number
        }
        Place next;
        Motion way;
        double drove = 0, drives = 0;
        int cuts = 0;
        for (double share = 1;; share *= kCut, ++cuts) {
            way = share * whole;
            next = moved(now, way, heavy);
            go_back(drag, heavy, next, way);
            drove = now.push.dot(way);
            drives = next.push.dot(way);
            if (cuts == kMostCuts || (drove >= 0 && drives >= -0.5 * drove)) break;
        }
        const double went = longest(way);
        if (cuts > 0) {
            trust *= 0.5;
        } else if (drives < 0) {
            trust = 0.5 * went;
        } else if (drives > 0.25 * drove) {
            trust = std::min(2 * trust, kLongestWay * a);
        }
        now = next;
        since_listed += went;
        if (since_listed > (kListed - 2 * kLongestWay) * a) {
            put(now.pose);
            problem_.look_around();
            since_listed = 0;
            now.push = push_at(now.pose, heavy);
        }
    }
    return false;
}

}  // namespace

bool seat(Aggregate& matter, const std::vector<ParticleId>& particles, const SeatProblem& problem) {
    RigidPiece piece(matter, particles, problem);
    Place place;
    for (double heavy = problem.heavy;; heavy = std::max(1.0, heavy / kLighter)) {
        if (!piece.settle(heavy, place)) {
            piece.put_back();
            return false;
        }
        if (heavy == 1) return true;
    }
}

}  // namespace swage
