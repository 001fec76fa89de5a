// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/blade_sweep.h"

namespace swage {

std::vector<std::array<Vec3, 3>> blade_sweep(const Machine& machine, int frames, double duration) {
    std::vector<std::array<Vec3, 3>> sweep;
    Drive before = drive_at(machine, 0, duration);
    for (int n = 1; n <= frames; ++n) {
        const Drive after = drive_at(machine, static_cast<double>(n) / frames, duration);
        for (std::size_t b = 0; b < machine.apparatus.blade.size(); ++b) {
            const std::vector<Vec3>& edge = machine.apparatus.blade[b].edge;
            const Pose &from = before.world_from_blade[b], &to = after.world_from_blade[b];
            for (std::size_t e = 0; e + 1 < edge.size(); ++e) {
                const Vec3 corner[4] = {from * edge[e], from * edge[e + 1], to * edge[e + 1],
                                        to * edge[e]};
                sweep.push_back({corner[0], corner[1], corner[2]});
                sweep.push_back({corner[0], corner[2], corner[3]});
            }
        }
        before = after;
    }
    return sweep;
}

}  // namespace swage
