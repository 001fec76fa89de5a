// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/move_outcome.h"

namespace swage {

void add_work(const Drive& from, const Drive& to, const std::vector<PartSum>& before,
              const std::vector<PartSum>& after, std::vector<double>& work) {
    const std::size_t tools = from.world_from_tool.size();
    for (std::size_t n = 0; n < work.size(); ++n) {
        const Pose& a = n < tools ? from.world_from_tool[n] : from.world_from_grip[n - tools];
        const Pose& b = n < tools ? to.world_from_tool[n] : to.world_from_grip[n - tools];
        work[n] += 0.5 * (before[n].force + after[n].force).dot(b.translation - a.translation) +
                   0.5 * (before[n].torque + after[n].torque).dot(turn_between(a, b));
    }
}

}  // namespace swage
