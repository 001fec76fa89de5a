// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: simple points for 6-connected bodies in a 26-connected outside, G. Bertrand and
// G. Malandain, "A new characterization of three-dimensional simple points", 1994.
#include "skin/cell_thinning.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

// The 27 cells around one, numbered (x + 1) + 3 (y + 1) + 9 (z + 1); 13 is the middle.
using Around = std::array<bool, 27>;

int steps_between(int a, int b, bool& adjacent26) {
    const int dx = std::abs(a % 3 - b % 3), dy = std::abs(a / 3 % 3 - b / 3 % 3);
    const int dz = std::abs(a / 9 - b / 9);
    adjacent26 = std::max({dx, dy, dz}) == 1;
    return dx + dy + dz;
}

int steps_from_middle(int n) {
    bool unused;
    return steps_between(n, 13, unused);
}

// Connected parts among `member`, over faces only or over faces, edges and corners; only parts that
// hold a cell at most `near` steps from the middle count.
int count_parts(const Around& member, bool faces_only, int near) {
    Around seen{};
    int parts = 0;
    for (int start = 0; start < 27; ++start) {
        if (!member[start] || seen[start] || steps_from_middle(start) > near) continue;
        ++parts;
        std::array<int, 27> open;
        int count = 0;
        open[count++] = start;
        seen[start] = true;
        while (count > 0) {
            const int at = open[--count];
            for (int n = 0; n < 27; ++n) {
                if (!member[n] || seen[n]) continue;
                bool adjacent26;
                const int steps = steps_between(at, n, adjacent26);
                if (faces_only ? steps != 1 : !adjacent26) continue;
                seen[n] = true;
                open[count++] = n;
            }
        }
    }
    return parts;
}

// Whether the middle may go without changing the topology of body and outside.
bool is_simple(const Around& body) {
    Around inner{}, outside{};
    for (int n = 0; n < 27; ++n) {
        if (n == 13) continue;
        inner[n] = body[n] && steps_from_middle(n) <= 2;
        outside[n] = !body[n];
    }
    return count_parts(inner, true, 1) == 1 && count_parts(outside, false, 3) == 1;
}

}  // namespace

std::vector<char> cells_to_draw(const Aggregate& matter) {
    constexpr float kSparse = 0.5f, kFull = 0.99f;
    std::vector<char> kept(matter.cell_fill.size(), 1);
    std::vector<CellId> sparse;
    for (std::size_t c = 0; c < kept.size(); ++c) {
        if (matter.cell_fill[c] < kSparse) sparse.push_back(static_cast<CellId>(c));
    }
    std::sort(sparse.begin(), sparse.end(), [&](CellId a, CellId b) {
        return std::pair(matter.cell_fill[a], a) < std::pair(matter.cell_fill[b], b);
    });
    for (CellId cell : sparse) {
        const auto corner = matter.lattice.cell_corners(cell);
        const bool severed =
            std::any_of(kCellConnection.begin(), kCellConnection.end(), [&](const auto& link) {
                return matter.connection[link.direction].weight[corner[link.corner]] <= 0;
            });
        if (severed) continue;
        const Vec3i site = matter.lattice.cell_site(cell);
        Around body{};
        bool at_full = false;
        for (int n = 0; n < 27; ++n) {
            const CellId next = matter.lattice.cell_at(
                site.x() + n % 3 - 1, site.y() + n / 3 % 3 - 1, site.z() + n / 9 - 1);
            body[n] = next >= 0 && kept[next];
            at_full = at_full || (body[n] && matter.cell_fill[next] >= kFull);
        }
        if (at_full && is_simple(body)) kept[cell] = 0;
    }
    return kept;
}

}  // namespace swage
