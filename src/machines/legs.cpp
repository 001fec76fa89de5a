// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/legs.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

constexpr int kHalvings = 6;             // of a frame
constexpr int kJumps = 4;                // legs of a frame that may stay bent: what jumps is one
constexpr double kMostTurn = 0.5 * kPi;  // of a leg
constexpr double kStrengthSlack = 0.01;  // of a load's full strength
// Where a leg is asked whether it is straight; not where what comes back to itself does so.
constexpr double kAsked[] = {0.2113, 0.5, 0.8090};

class Straightness {
  public:
    Straightness(const Machine& machine, int frames, double slack)
        : machine_(machine), slack_(slack), reach_(0.5 * machine.frame.size.norm()) {
        full_.resize(machine.load_strength.size(), 0.0);
        for (int n = 0; n < frames; ++n) {
            for (double s : kAsked) note(drive_at(machine, (n + s) / frames, 1));
            note(drive_at(machine, static_cast<double>(n + 1) / frames, 1));
        }
        note(drive_at(machine, 0, 1));
    }

    bool of(double begin, double end) const {
        const Drive from = drive_at(machine_, begin, 1), to = drive_at(machine_, end, 1);
        if (turns_far(from.world_from_tool, to.world_from_tool) ||
            turns_far(from.world_from_grip, to.world_from_grip) ||
            turns_far(from.world_from_blade, to.world_from_blade)) {
            return false;
        }
        for (double s : kAsked) {
            const Drive told = drive_between(from, to, s),
                        is = drive_at(machine_, begin + s * (end - begin), 1);
            if (!are_near(told.world_from_tool, is.world_from_tool) ||
                !are_near(told.world_from_grip, is.world_from_grip) ||
                !are_near(told.world_from_blade, is.world_from_blade) ||
                !is_near(told.gravity_strength, is.gravity_strength, full_gravity_)) {
                return false;
            }
            for (std::size_t n = 0; n < is.load_strength.size(); ++n) {
                if (!is_near(told.load_strength[n], is.load_strength[n], full_[n])) return false;
            }
        }
        return true;
    }

  private:
    void note(const Drive& drive) {
        for (std::size_t n = 0; n < full_.size(); ++n) {
            full_[n] = std::max(full_[n], std::abs(drive.load_strength[n]));
        }
        full_gravity_ = std::max(full_gravity_, std::abs(drive.gravity_strength));
    }
    static bool is_near(double a, double b, double full) {
        return std::abs(a - b) <= kStrengthSlack * full;
    }
    static bool turns_far(const std::vector<Pose>& a, const std::vector<Pose>& b) {
        for (std::size_t n = 0; n < a.size(); ++n) {
            if (turn_between(a[n], b[n]).norm() > kMostTurn) return true;
        }
        return false;
    }
    bool are_near(const std::vector<Pose>& a, const std::vector<Pose>& b) const {
        for (std::size_t n = 0; n < a.size(); ++n) {
            const double off = (a[n].translation - b[n].translation).norm() +
                               reach_ * turn_between(a[n], b[n]).norm();
            if (off > slack_) return false;
        }
        return true;
    }

    const Machine& machine_;
    double slack_, reach_;
    std::vector<double> full_;  // the largest strength of each load, by samples
    double full_gravity_ = 0;
};

}  // namespace

Legs legs_of(const Machine& machine, int frames, double slack) {
    const Straightness straight(machine, frames, slack);
    Legs legs;
    int bent = 0;
    const auto divide = [&](const auto& again, const Leg& leg, int halvings) -> void {
        if (straight.of(leg.begin, leg.end)) {
            legs.leg.push_back(leg);
        } else if (halvings == kHalvings) {
            legs.leg.push_back(leg);
            ++bent;
        } else {
            const double middle = 0.5 * (leg.begin + leg.end);
            again(again, {leg.frame, leg.begin, middle}, halvings + 1);
            again(again, {leg.frame, middle, leg.end}, halvings + 1);
        }
    };
    for (int n = 0; n < frames; ++n) {
        bent = 0;
        divide(divide, {n, static_cast<double>(n) / frames, static_cast<double>(n + 1) / frames},
               0);
        legs.lost += bent > kJumps;
    }
    return legs;
}

std::vector<Drive> drives_of(const Machine& machine, const std::vector<Leg>& legs, int steps,
                             double duration) {
    std::vector<Drive> drives{drive_at(machine, legs.front().begin, duration)};
    for (const Leg& leg : legs) {
        for (int n = 1; n < steps; ++n) {
            const double s = static_cast<double>(n) / steps;
            drives.push_back(drive_at(machine, (1 - s) * leg.begin + s * leg.end, duration));
        }
        drives.push_back(drive_at(machine, leg.end, duration));
    }
    return drives;
}

}  // namespace swage
