// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/open_faces.h"

#include <array>
#include <cstdint>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr std::size_t kParticles = 4096, kRuns = 256;  // a chunk

// A bit for each direction in which a connection from this corner lies in the cell.
constexpr std::array<unsigned, 8> kOfCorner = [] {
    std::array<unsigned, 8> bits{};
    for (const CellConnection& c : kCellConnection) bits[c.corner] |= 1u << c.direction;
    return bits;
}();

// Of each particle a bit for each connection from it that does not hold.
std::vector<std::uint16_t> open_connections(const Aggregate& matter) {
    std::vector<std::uint16_t> open(matter.particle_count(), 0);
    parallel_chunks(open.size(), kParticles, [&](std::size_t begin, std::size_t end) {
        std::array<float, kParticles> weight;
        for (int d = 0; d < kForwardCount; ++d) {
            matter.connection[d].weight.copy(begin, end - begin, weight.data());
            for (std::size_t p = begin; p < end; ++p) {
                open[p] |= static_cast<std::uint16_t>((weight[p - begin] <= 0) << d);
            }
        }
    });
    return open;
}

}  // namespace

std::vector<char> whole_cells(const Aggregate& matter) {
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    std::vector<char> whole(matter.cell_fill.size(), 0);
    if (runs.empty()) return whole;  // nor need there be connections
    const std::vector<std::uint16_t> open = open_connections(matter);
    parallel_each(runs.size(), kRuns, [&](std::size_t r) {
        for (int n = 0; n < runs[r].count; ++n) {
            unsigned gone = 0;
            for (int c = 0; c < 8; ++c) gone |= open[runs[r].corner(n, c)] & kOfCorner[c];
            whole[runs[r].first + n] = gone == 0;
        }
    });
    return whole;
}

}  // namespace swage
