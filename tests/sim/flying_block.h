// SPDX-License-Identifier: GPL-3.0-or-later
// A body that flies, and a blade that comes down beside it.
#pragma once

#include "tests/shared/block.h"
#include "tests/sim/motion.h"

namespace swage::test {

// Of 6 x 6 x 2 cells of 2 cm about the origin; the blade parts it across x.
struct FlyingBlock {
    explicit FlyingBlock(const Vec3& speed) : block(make_block(6, 6, 2, 0.02, kSpringy)) {
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            block.particle_velocity.set(p, speed);
        }
        apparatus.name = "cut";
        apparatus.blade.push_back({"blade", {Vec3(0.003, 0, -1), Vec3(0.003, 0, 1)}, {}});
    }
    static Drive with_edge_at(double height, double time) {
        Drive drive = still(time);
        drive.world_from_blade = {Pose{Quat::Identity(), Vec3(0, height, 0)}};
        return drive;
    }

    Aggregate block;
    Apparatus apparatus;
};

}  // namespace swage::test
