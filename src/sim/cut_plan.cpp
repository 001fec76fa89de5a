// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cut_plan.h"

#include <algorithm>
#include <set>
#include <utility>

namespace swage {

namespace {

using Connection = std::pair<int, ParticleId>;

Connection connection_of(const SeverEvent& e) { return {e.direction, e.lower}; }

}  // namespace

CutPlan take_out(CutPlan& plan, const std::vector<char>& blades) {
    CutPlan own(plan.size());
    for (std::size_t n = 0; n < plan.size(); ++n) {
        const auto first =
            std::stable_partition(plan[n].begin(), plan[n].end(), [&](const SeverEvent& e) {
                return !blades.empty() && !blades[static_cast<std::size_t>(e.blade)];
            });
        own[n].assign(first, plan[n].end());
        plan[n].erase(first, plan[n].end());
    }
    return own;
}

void add_plan(CutPlan& plan, const CutPlan& more) {
    for (std::size_t n = 0; n < plan.size(); ++n) {
        plan[n].insert(plan[n].end(), more[n].begin(), more[n].end());
    }
}

bool severs_any(const CutPlan& plan) {
    return std::ranges::any_of(plan, [](const auto& events) { return !events.empty(); });
}

bool severs_more(const CutPlan& plan, const CutPlan& than) {
    std::set<Connection> known;
    for (const auto& events : than) {
        for (const SeverEvent& e : events) known.insert(connection_of(e));
    }
    return std::ranges::any_of(plan, [&](const auto& events) {
        return std::ranges::any_of(
            events, [&](const SeverEvent& e) { return !known.contains(connection_of(e)); });
    });
}

void drop_doubles(std::vector<SeverEvent>& events) {
    std::set<Connection> known;
    std::erase_if(events,
                  [&](const SeverEvent& e) { return !known.insert(connection_of(e)).second; });
}

void add_sides(std::vector<PointSide>& sides, const std::vector<PointSide>& more) {
    sides.insert(sides.end(), more.begin(), more.end());
    std::ranges::stable_sort(sides, {}, &PointSide::point);
    std::vector<PointSide> all;
    for (const PointSide& one : sides) {
        if (!all.empty() && all.back().point == one.point) {
            all.back().corners &= one.corners;
        } else {
            all.push_back(one);
        }
    }
    sides = std::move(all);
}

}  // namespace swage
