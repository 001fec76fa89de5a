// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/row_groups.h"

namespace swage {

RowGroups::RowGroups(const std::vector<CellRun>& runs, const Vec3i& size, const Vec3i& ratio)
    : across_(size.y()), run_(runs.size()), begin_(std::size_t(size.y()) * size.z() + 1, 0) {
    const auto row_of = [&](const CellRun& run) {
        return row_at(run.j / ratio.y(), run.k / ratio.z());
    };
    for (const CellRun& run : runs) ++begin_[row_of(run) + 1];
    for (std::size_t n = 1; n < begin_.size(); ++n) begin_[n] += begin_[n - 1];
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t r = 0; r < runs.size(); ++r) run_[next[row_of(runs[r])]++] = r;
}

}  // namespace swage
