// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/passed_watch.h"

#include <algorithm>
#include <utility>

#include "sim/blade_way.h"

namespace swage {

namespace {

bool is_one(char marked) { return marked != 0; }

}  // namespace

PassedWatch::PassedWatch(const std::vector<WorkPiece>& bodies, const Apparatus& apparatus,
                         const SimSettings& settings, std::vector<std::vector<char>> again)
    : bodies_(bodies),
      apparatus_(apparatus),
      in_motion_(in_motion(settings.solver)),
      again_(std::move(again)) {
    const bool any_again = std::ranges::any_of(
        again_, [](const auto& blades) { return std::ranges::any_of(blades, is_one); });
    if (apparatus.blade.empty() || !(in_motion_ || any_again)) return;
    for (const WorkPiece& body : bodies) before_.push_back(body.matter.particle_position);
}

std::size_t PassedWatch::count_passed(const Drive& from, const Drive& to,
                                      const Simulation& simulation) const {
    std::size_t count = 0;
    if (!in_motion_) return count;
    for (std::size_t b = 0; b < before_.size(); ++b) {
        count += passed_in(b, {}, from, to, simulation);
    }
    return count;
}

std::size_t PassedWatch::count_again(const Drive& from, const Drive& to,
                                     const Simulation& simulation) const {
    std::size_t count = 0;
    for (std::size_t b = 0; b < before_.size(); ++b) {
        if (!std::ranges::any_of(again_[b], is_one)) continue;
        count += passed_in(b, again_[b], from, to, simulation);
    }
    return count;
}

std::size_t PassedWatch::passed_in(std::size_t body, const std::vector<char>& blades,
                                   const Drive& from, const Drive& to,
                                   const Simulation& simulation) const {
    const auto passed = [&](const Aggregate& matter) {
        return swage::count_passed(matter, before_[body], apparatus_, from, to, blades);
    };
    // What is planned is mostly nothing, and its matter a copy.
    return passed(bodies_[body].matter) > 0 ? passed(simulation.planned(body)) : 0;
}

}  // namespace swage
