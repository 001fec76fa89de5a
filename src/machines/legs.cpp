// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/legs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

namespace swage {

namespace {

constexpr int kHalvings = 6;  // of a frame
static_assert(1 << kHalvings == kMostLegs);
constexpr int kMostHalvings = 12;        // the same for loads that jump, in motion
constexpr int kJumps = 4;                // legs of a frame that may stay bent: what jumps is one
constexpr double kNoLeg = 1e-12;         // of the stage, by which its beginning may be rounded
constexpr double kMostTurn = 0.5 * kPi;  // of a leg
constexpr double kStrengthSlack = 0.01, kSlackInMotion = 0.001;  // of a load's full strength
// Where a leg is asked whether it is straight; not where what comes back to itself does so.
constexpr double kAsked[] = {0.2113, 0.5, 0.8090};
constexpr int kLooks = 256;          // at loads, in a frame
constexpr int kMostLooks = 1 << 20;  // in all
constexpr double kHeapShare = 24;    // [byte] that a short array takes beside what it holds

constexpr double kLook = 1e-3;      // of a leg: between the poses that its ends' pace is told from
constexpr double kEven = 1e-9;      // of the work-piece, that what goes evenly may be off
constexpr double kSmooth = 0.0025;  // how far off a bent way may be, of what a straight one is

std::optional<WayEnds> ends_of(const std::array<Pose, 6>& pose, double reach) {
    const auto to = [&](int n) { return twist_between(pose[0], pose[n]); };
    const Twist all = to(5);
    const double per = 0.5 / kLook;
    const WayEnds ends{per * (4 * to(1) - to(2)), per * (3 * all - 4 * to(4) + to(3))};
    double off = 0;
    for (const Twist& uneven : {ends.leaving - all, ends.coming - all}) {
        off += uneven.shift.norm() + reach * uneven.turn.norm();
    }
    return off > kEven * reach ? std::optional(ends) : std::nullopt;
}

// Gives the last of the drives of a leg its ways from the first.
void find_ways(const Machine& machine, double begin, double end, Drive& last) {
    const double reach = 0.5 * machine.frame.size.norm(), look = kLook * (end - begin);
    std::array<Drive, 6> drive;
    const double at[] = {begin, begin + look, begin + 2 * look, end - 2 * look, end - look, end};
    for (std::size_t n = 0; n < drive.size(); ++n) drive[n] = drive_at(machine, at[n], 1);
    const auto find = [&](std::vector<Pose> Drive::*poses,
                          std::vector<std::optional<WayEnds>>& ways) {
        for (std::size_t p = 0; p < (last.*poses).size(); ++p) {
            std::array<Pose, 6> pose;
            for (std::size_t n = 0; n < drive.size(); ++n) pose[n] = (drive[n].*poses)[p];
            ways.push_back(ends_of(pose, reach));
        }
    };
    find(&Drive::world_from_tool, last.tool_way);
    find(&Drive::world_from_grip, last.grip_way);
}

long looks_in(int frames) {
    return static_cast<long>(frames) * std::clamp(kMostLooks / frames, 4, kLooks);
}

class Straightness {
  public:
    Straightness(const Machine& machine, int frames, double slack, bool in_motion)
        : machine_(machine),
          slack_(slack),
          strength_slack_(in_motion ? kSlackInMotion : kStrengthSlack),
          reach_(0.5 * machine.frame.size.norm()),
          looks_(looks_in(frames)) {
        full_.resize(machine.load_strength.size() + 1, 0.0);
        for (long n = 0; n <= looks_; ++n) {
            strength_.push_back(
                strengths_at(machine, static_cast<double>(n) / static_cast<double>(looks_)));
            for (std::size_t l = 0; l < full_.size(); ++l) {
                full_[l] = std::max(full_[l], std::abs(strength_.back()[l]));
            }
        }
    }

    bool of(double begin, double end) const {
        return of_poses(begin, end) && of_strengths(begin, end);
    }

    bool of_poses(double begin, double end) const {
        const Drive from = drive_at(machine_, begin, 1), to = drive_at(machine_, end, 1);
        if (turns_far(from.world_from_tool, to.world_from_tool) ||
            turns_far(from.world_from_grip, to.world_from_grip) ||
            turns_far(from.world_from_blade, to.world_from_blade)) {
            return false;
        }
        return std::all_of(std::begin(kAsked), std::end(kAsked), [&](double s) {
            const Drive told = drive_between(from, to, s),
                        is = drive_at(machine_, begin + s * (end - begin), 1);
            return are_near(told.world_from_tool, is.world_from_tool) &&
                   are_near(told.world_from_grip, is.world_from_grip) &&
                   are_near(told.world_from_blade, is.world_from_blade);
        });
    }

    // Whether the way with its ends' pace has the machine's accelerations too.
    bool is_smooth(double begin, double end) const {
        const Drive from = drive_at(machine_, begin, 1);
        Drive to = drive_at(machine_, end, 1), straight = to;
        find_ways(machine_, begin, end, to);
        return std::all_of(std::begin(kAsked), std::end(kAsked), [&](double s) {
            const Drive is = drive_at(machine_, begin + s * (end - begin), 1);
            const double off = off_by(drive_between(from, to, s), is);
            return off <= kEven * reach_ ||
                   off <= kSmooth * off_by(drive_between(from, straight, s), is);
        });
    }

  private:
    bool of_strengths(double begin, double end) const {
        const std::vector<double> from = strengths_at(machine_, begin),
                                  to = strengths_at(machine_, end);
        const auto is_near = [&](double t, const std::vector<double>& is) {
            const double s = (t - begin) / (end - begin);
            for (std::size_t l = 0; l < is.size(); ++l) {
                const double told = (1 - s) * from[l] + s * to[l];
                if (!(std::abs(told - is[l]) <= strength_slack_ * full_[l])) return false;
            }
            return true;
        };
        for (double s : kAsked) {
            const double t = begin + s * (end - begin);
            if (!is_near(t, strengths_at(machine_, t))) return false;
        }
        const auto looks = static_cast<double>(looks_);
        for (long n = static_cast<long>(begin * looks) + 1; n < end * looks; ++n) {
            if (!is_near(static_cast<double>(n) / looks, strength_[std::size_t(n)])) return false;
        }
        return true;
    }
    static bool turns_far(const std::vector<Pose>& a, const std::vector<Pose>& b) {
        for (std::size_t n = 0; n < a.size(); ++n) {
            if (turn_between(a[n], b[n]).norm() > kMostTurn) return true;
        }
        return false;
    }
    double off_by(const Pose& a, const Pose& b) const {
        return (a.translation - b.translation).norm() + reach_ * turn_between(a, b).norm();
    }
    // The tool or grip that is farthest off [m].
    double off_by(const Drive& a, const Drive& b) const {
        double most = 0;
        for (std::size_t n = 0; n < a.world_from_tool.size(); ++n) {
            most = std::max(most, off_by(a.world_from_tool[n], b.world_from_tool[n]));
        }
        for (std::size_t n = 0; n < a.world_from_grip.size(); ++n) {
            most = std::max(most, off_by(a.world_from_grip[n], b.world_from_grip[n]));
        }
        return most;
    }
    bool are_near(const std::vector<Pose>& a, const std::vector<Pose>& b) const {
        for (std::size_t n = 0; n < a.size(); ++n) {
            if (off_by(a[n], b[n]) > slack_) return false;
        }
        return true;
    }

    const Machine& machine_;
    double slack_, strength_slack_, reach_;
    long looks_;                                 // over the stage
    std::vector<std::vector<double>> strength_;  // at each, and at the end
    std::vector<double> full_;                   // the largest of each
};

}  // namespace

Legs legs_of(const Machine& machine, int frames, double slack, bool in_motion, double begin) {
    const Straightness straight(machine, frames, slack, in_motion);
    Legs legs;
    std::vector<std::size_t> bent;
    const auto divide = [&](const auto& again, const Leg& leg, int halvings) -> void {
        const bool is_straight = straight.of(leg.begin, leg.end);
        const bool bends = in_motion && straight.is_smooth(leg.begin, leg.end);
        if ((is_straight && bends == in_motion) || halvings == 0) {
            if (!is_straight) bent.push_back(legs.leg.size());
            legs.leg.push_back({leg.frame, leg.begin, leg.end, bends});
            return;
        }
        const double middle = 0.5 * (leg.begin + leg.end);
        again(again, {leg.frame, leg.begin, middle}, halvings - 1);
        again(again, {leg.frame, middle, leg.end}, halvings - 1);
    };
    for (int n = 0; n < frames; ++n) {
        const double end = static_cast<double>(n + 1) / frames;
        if (end - begin <= kNoLeg) continue;
        bent.clear();
        const std::size_t first = legs.leg.size();
        divide(divide, {n, std::max(begin, static_cast<double>(n) / frames), end}, kHalvings);
        legs.lost += bent.size() > kJumps;
        if (!in_motion || bent.empty() || bent.size() > kJumps) continue;
        const std::vector<Leg> rough(legs.leg.begin() + std::ptrdiff_t(first), legs.leg.end());
        legs.leg.resize(first);
        const std::vector<std::size_t> jumps = bent;
        for (std::size_t l = 0; l < rough.size(); ++l) {
            if (std::binary_search(jumps.begin(), jumps.end(), first + l) &&
                straight.of_poses(rough[l].begin, rough[l].end)) {
                divide(divide, rough[l], kMostHalvings - kHalvings);
            } else {
                legs.leg.push_back(rough[l]);
            }
        }
    }
    return legs;
}

std::vector<Drive> drives_of(const Machine& machine, const std::vector<Leg>& legs, int steps,
                             double duration) {
    std::vector<Drive> drives;
    drives.reserve(legs.size() * static_cast<std::size_t>(steps) + 1);
    drives.push_back(drive_at(machine, legs.front().begin, duration));
    for (const Leg& leg : legs) {
        for (int n = 1; n < steps; ++n) {
            const double s = static_cast<double>(n) / steps;
            drives.push_back(drive_at(machine, (1 - s) * leg.begin + s * leg.end, duration));
        }
        drives.push_back(drive_at(machine, leg.end, duration));
        if (leg.bends) find_ways(machine, leg.begin, leg.end, drives.back());
    }
    return drives;
}

double bytes_of_way(const MachineSpec& spec, int frames, bool in_motion) {
    const auto loads = static_cast<double>(spec.load.size());
    const auto parts = static_cast<double>(spec.tool.size() + spec.grip.size() + spec.blade.size());
    const double looks = static_cast<double>(looks_in(frames)) *
                         (sizeof(std::vector<double>) + kHeapShare + 8 * (loads + 1));
    const double way = in_motion ? 2 * kHeapShare + parts * sizeof(std::optional<WayEnds>) : 0;
    const double drives =
        frames * (sizeof(Drive) + 2 * kHeapShare + parts * sizeof(Pose) + 8 * loads + way);
    // What was looked at is forgotten before the drives are made.
    return frames * static_cast<double>(sizeof(Leg)) + std::max(looks, drives);
}

}  // namespace swage
