// SPDX-License-Identifier: GPL-3.0-or-later
// Counts what moves past the edge of a blade between two places of its way, where that sweeps
// nothing.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/work_piece.h"
#include "sim/settings.h"

namespace swage {

class PassedWatch {
  public:
    // As a leg of the machine's way begins; `is_cut`: of the bodies whose cut is settled, which are
    // not looked at. Keeps a reference to the bodies and the apparatus.
    PassedWatch(const std::vector<WorkPiece>& bodies, const std::vector<char>& is_cut,
                const Apparatus& apparatus, const SimSettings& settings);

    // As it ends: the connections that have passed.
    std::size_t count_passed(const Drive& from, const Drive& to) const;

  private:
    const std::vector<WorkPiece>& bodies_;
    const Apparatus& apparatus_;
    std::vector<Vec3Array> before_;  // of each body; empty: not looked at
};

}  // namespace swage
