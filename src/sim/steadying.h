// SPDX-License-Identifier: GPL-3.0-or-later
// What loads and gravity leave over, all in all, along the ways that grips leave a piece free:
// patches of a surface are as fine as the cells, and equilibria would go any way for what these are
// short of balance. What is more takes the piece along for ever.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/gripped_pieces.h"

namespace swage {

// Of all loads and gravity on a piece: what they are short of balance by is no more.
inline constexpr double kLittlePush = 0.05;

// A piece, by what all loads and gravity on it come to.
struct LeftFree {
    // Along those translations that no grip bars, whatever shape the piece takes [N].
    Vec3 push = Vec3::Zero();
    // How it sets out, as a rigid body, on any way that grips leave: turns are about its centre.
    Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();  // [m/s2], [rad/s2]
    double drive = 0;                                // what drives it so, about [N]
    double size = 0;                                 // of loads and gravity, one by one [N]

    bool is_pushed_off() const { return push.norm() > kLittlePush * size; }
    // It may come to rest where it has turned.
    bool is_driven() const { return drive > kLittlePush * size; }
};

// Of each piece. `push`: of loads and gravity on each particle [N].
std::vector<LeftFree> left_free(const Aggregate& matter, const Apparatus& apparatus,
                                const GrippedPieces& gripped, const Drive& now,
                                const Vec3Array& push);

// Takes it off where it is no more.
void add_steadying_forces(const Aggregate& matter, const Apparatus& apparatus,
                          const GrippedPieces& gripped, const Drive& now, const Vec3Array& push,
                          Vec3Array& force);

}  // namespace swage
