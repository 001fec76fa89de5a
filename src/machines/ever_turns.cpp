// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/ever_turns.h"

namespace swage {

bool ever_turns(const Motion& motion) {
    constexpr int kLooks = 256;
    constexpr double kTurned = 1e-9;  // [rad]
    const int looks = motion.turns() ? kLooks : 0;
    for (int n = 0; n <= looks; ++n) {
        if (rotation_of(motion.at(double(n) / kLooks).rotation).norm() > kTurned) return true;
    }
    return false;
}

}  // namespace swage
