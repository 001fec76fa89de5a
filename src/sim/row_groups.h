// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of cells, for loops that work on whole rows at once.
#pragma once

#include <span>
#include <vector>

#include "matter/lattice.h"

namespace swage {

// Runs of cells by the row of coarse cells in which they lie, in their order: of a lattice of
// `size` coarse cells, each of `ratio` cells along its axes.
class RowGroups {
  public:
    RowGroups(const std::vector<CellRun>& runs, const Vec3i& size, const Vec3i& ratio);

    std::size_t count() const { return begin_.size() - 1; }
    // Their places among the runs.
    std::span<const std::size_t> of(std::size_t row) const {
        return {run_.data() + begin_[row], begin_[row + 1] - begin_[row]};
    }
    std::span<const std::size_t> of(int j, int k) const { return of(row_at(j, k)); }

  private:
    std::size_t row_at(int j, int k) const { return std::size_t(k) * across_ + j; }

    std::size_t across_;
    std::vector<std::size_t> run_, begin_;
};

}  // namespace swage
