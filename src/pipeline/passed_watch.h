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
    // `again`: of each body the blades that go through it again.
    PassedWatch(const std::vector<WorkPiece>& bodies, const Apparatus& apparatus,
                const SimSettings& settings, std::vector<std::vector<char>> again);

    // As it ends: the connections that have passed in motion, without those that are still to be
    // severed.
    std::size_t count_passed(const Drive& from, const Drive& to,
                             const Simulation& simulation) const;
    // Those past blades that go through again, at rest too.
    std::size_t count_again(const Drive& from, const Drive& to, const Simulation& simulation) const;

  private:
    std::size_t passed_in(std::size_t body, const std::vector<char>& blades, const Drive& from,
                          const Drive& to, const Simulation& simulation) const;

    const std::vector<WorkPiece>& bodies_;
    const Apparatus& apparatus_;
    bool in_motion_;
    std::vector<std::vector<char>> again_;
    std::vector<Vec3Array> before_;  // of each body; none: nothing is looked for
};

}  // namespace swage
