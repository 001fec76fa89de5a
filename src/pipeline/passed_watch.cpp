// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/passed_watch.h"

#include "sim/blade_way.h"

namespace swage {

PassedWatch::PassedWatch(const std::vector<WorkPiece>& bodies, const std::vector<char>& is_cut,
                         const Apparatus& apparatus, const SimSettings& settings)
    : bodies_(bodies), apparatus_(apparatus), before_(bodies.size()) {
    if (apparatus.blade.empty() || !in_motion(settings.solver)) return;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!is_cut[b]) before_[b] = bodies[b].matter.particle_position;
    }
}

std::size_t PassedWatch::count_passed(const Drive& from, const Drive& to) const {
    std::size_t count = 0;
    for (std::size_t b = 0; b < before_.size(); ++b) {
        if (before_[b].size() == 0) continue;
        count += swage::count_passed(bodies_[b].matter, before_[b], apparatus_, from, to);
    }
    return count;
}

}  // namespace swage
