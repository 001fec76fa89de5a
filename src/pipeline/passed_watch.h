// SPDX-License-Identifier: GPL-3.0-or-later
// Counts what moves past the edge of a blade between two places of its way, where that sweeps
// nothing.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/work_piece.h"
#include "sim/advance.h"
#include "sim/settings.h"

namespace swage {

class PassedWatch {
  public:
    // As a leg of the machine's way begins. Keeps a reference to the bodies and the apparatus.
    PassedWatch(const std::vector<WorkPiece>& bodies, const Apparatus& apparatus,
                const SimSettings& settings);

    // As it ends: the connections that have passed, without those that are still to be severed.
    std::size_t count_passed(const Drive& from, const Drive& to,
                             const Simulation& simulation) const;

  private:
    const std::vector<WorkPiece>& bodies_;
    const Apparatus& apparatus_;
    std::vector<Vec3Array> before_;  // of each body; none: nothing is looked for
};

}  // namespace swage
