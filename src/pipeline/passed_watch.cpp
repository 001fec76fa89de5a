// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/passed_watch.h"

#include "sim/blade_way.h"

namespace swage {

PassedWatch::PassedWatch(const std::vector<WorkPiece>& bodies, const Apparatus& apparatus,
                         const SimSettings& settings)
    : bodies_(bodies), apparatus_(apparatus) {
    if (apparatus.blade.empty() || !in_motion(settings.solver)) return;
    for (const WorkPiece& body : bodies) before_.push_back(body.matter.particle_position);
}

std::size_t PassedWatch::count_passed(const Drive& from, const Drive& to,
                                      const Simulation& simulation) const {
    std::size_t count = 0;
    for (std::size_t b = 0; b < before_.size(); ++b) {
        const auto passed = [&](const Aggregate& matter) {
            return swage::count_passed(matter, before_[b], apparatus_, from, to);
        };
        // What is planned is mostly nothing, and its matter a copy.
        if (passed(bodies_[b].matter) > 0) count += passed(simulation.planned(b));
    }
    return count;
}

}  // namespace swage
