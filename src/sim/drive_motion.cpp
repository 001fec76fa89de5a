// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/drive_motion.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

// Shares of the most that a tool has carried: loaded, and not any more.
constexpr double kLoadedShare = 0.3, kUnloadedShare = 0.1;
constexpr double kLikewise = 0.1;  // cosine of two motions

}  // namespace

int increments_between(const RestingContacts& contacts, const Aggregate& matter, const Drive& from,
                       const Drive& to, std::size_t every) {
    const double travel = contacts.travel(matter, from, to, every);
    return std::max(1, static_cast<int>(std::ceil(travel / matter.lattice.spacing)));
}

DriveMotion motion_between(const Apparatus& apparatus, const Drive& from, const Drive& to,
                           double size) {
    DriveMotion motion;
    const auto add = [&](const std::vector<Pose>& a, const std::vector<Pose>& b) {
        for (std::size_t n = 0; n < a.size(); ++n) {
            const Vec3 way = b[n].translation - a[n].translation;
            const Vec3 turn = size * turn_between(a[n], b[n]);
            motion.insert(motion.end(), {way.x(), way.y(), way.z(), turn.x(), turn.y(), turn.z()});
        }
    };
    add(from.world_from_tool, to.world_from_tool);
    add(from.world_from_grip, to.world_from_grip);
    for (std::size_t l = 0; l < apparatus.load.size(); ++l) {
        motion.push_back(size * (to.load_strength[l] - from.load_strength[l]));
    }
    motion.push_back(size * (to.gravity_strength - from.gravity_strength));
    return motion;
}

void Foresight::go_on(const DriveMotion& motion, double most, Vec3Array& position) const {
    if (motion_.empty()) return;
    double along = 0, square = 0;
    for (std::size_t n = 0; n < motion.size(); ++n) {
        along += motion[n] * motion_[n];
        square += motion_[n] * motion_[n];
    }
    if (!(along > 0)) return;
    const double ratio = along / square;
    const auto extrapolate = [&](std::vector<double>& now, const std::vector<double>& before) {
        for (std::size_t p = 0; p < now.size(); ++p) {
            now[p] += std::clamp(ratio * (now[p] - before[p]), -most, most);
        }
    };
    extrapolate(position.x, start_.x);
    extrapolate(position.y, start_.y);
    extrapolate(position.z, start_.z);
}

void Foresight::keep(const Vec3Array& start, DriveMotion motion) {
    start_ = start;
    motion_ = std::move(motion);
}

SlipWatch::SlipWatch(const Apparatus& apparatus) {
    for (const Tool& tool : apparatus.tool) tool_.push_back({.name = tool.name});
}

bool SlipWatch::draws_back(const DriveMotion& motion) const {
    for (std::size_t t = 0; t < tool_.size(); ++t) {
        double along = 0, now = 0, then = 0;
        for (std::size_t n = 0; n < 6; ++n) {
            const double way = motion[6 * t + n], pressing = tool_[t].pressing[n];
            along += way * pressing;
            now += way * way;
            then += pressing * pressing;
        }
        if (now > 0 && then > 0 && along < kLikewise * std::sqrt(now * then)) return true;
    }
    return false;
}

void SlipWatch::keep(const std::vector<PartSum>& load, const std::vector<double>& work,
                     const DriveMotion& motion, bool may_part, std::vector<std::string>& lost) {
    for (std::size_t t = 0; t < tool_.size(); ++t) {
        Bearing& tool = tool_[t];
        const double bears = load[t].size;
        tool.most = std::max(tool.most, bears);
        if (may_part) {
            tool.carries = false;
        } else if (bears > kLoadedShare * tool.most) {
            tool.carries = true;
        } else if (tool.carries && bears <= kUnloadedShare * tool.most) {
            tool.carries = false;
            lost.push_back(tool.name);
        }
        if (!tool.carries || !(work[t] > 0)) continue;
        std::copy_n(motion.begin() + std::ptrdiff_t(6 * t), 6, tool.pressing.begin());
    }
}

void SlipWatch::forget() {
    for (Bearing& tool : tool_) tool.carries = false;
}

}  // namespace swage
