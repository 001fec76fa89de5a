// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: simple points for 6-connected bodies in a 26-connected outside, G. Bertrand and
// G. Malandain, "A new characterization of three-dimensional simple points", 1994.
#include "skin/voxel_thinning.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr int kMostPasses = 8;
constexpr std::size_t kChunk = 16;  // runs of cells
constexpr float kFull = 0.99f;
// Spacings. NOTE: were all those taken that lie more outside than inside, each step that they leave
// would make a fold of the surface drawn around them.
constexpr double kOutside = 0.35;

// The 27 voxels around one, numbered (x + 1) + 3 (y + 1) + 9 (z + 1); 13 is the middle.
using Around = std::array<bool, 27>;
constexpr int kMiddle = 13;

struct Steps {
    int all, longest;  // along the axes
};
Steps steps_between(int a, int b) {
    const int x = std::abs(a % 3 - b % 3), y = std::abs(a / 3 % 3 - b / 3 % 3),
              z = std::abs(a / 9 - b / 9);
    return {x + y + z, std::max({x, y, z})};
}

// Connected parts among `member`, over faces only or over faces, edges and corners; only parts that
// hold a voxel at most `near` steps from the middle count.
int count_parts(const Around& member, bool faces_only, int near) {
    Around seen{};
    int parts = 0;
    for (int start = 0; start < 27; ++start) {
        if (!member[start] || seen[start] || steps_between(start, kMiddle).all > near) continue;
        ++parts;
        std::array<int, 27> open;
        int count = 0;
        open[count++] = start;
        seen[start] = true;
        while (count > 0) {
            const int at = open[--count];
            for (int n = 0; n < 27; ++n) {
                if (!member[n] || seen[n]) continue;
                const Steps steps = steps_between(at, n);
                if (faces_only ? steps.all != 1 : steps.longest != 1) continue;
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
        if (n == kMiddle) continue;
        inner[n] = body[n] && steps_between(n, kMiddle).all <= 2;
        outside[n] = !body[n];
    }
    return count_parts(inner, true, 1) == 1 && count_parts(outside, false, 3) == 1;
}

class Thinning {
  public:
    Thinning(const Aggregate& matter, const SurfaceSamples& samples)
        : matter_(matter), kept_(matter.cell_fill.size(), kAllCorners) {
        if (!samples.empty()) find_outside(samples);
    }

    std::vector<CornerMask> run() {
        bool any = true;
        for (int pass = 0; any && pass < kMostPasses; ++pass) {
            any = false;
            for (Candidate& candidate : candidate_) {
                if (candidate.gone || !may_go(candidate)) continue;
                kept_[candidate.cell] &= static_cast<CornerMask>(~(1 << candidate.corner));
                candidate.gone = any = true;
            }
        }
        return std::move(kept_);
    }

  private:
    struct Candidate {
        double height;  // of its middle above the surface, in spacings
        CellId cell;
        int corner;
        // That the voxels around it lie in, a bit for each axis along which they leave its own: -1
        // where there is none.
        std::array<CellId, 8> beside;
        bool gone = false;
    };

    // The farthest out first.
    void find_outside(const SurfaceSamples& samples) {
        const std::vector<CellRun>& runs = matter_.lattice.cell_run;
        const auto find = [&](std::size_t begin, std::size_t end, std::vector<Candidate>& found) {
            for (std::size_t r = begin; r < end; ++r) {
                for (int n = 0; n < runs[r].count; ++n) {
                    find_in_cell(samples, runs[r].first + n, {runs[r].i + n, runs[r].j, runs[r].k},
                                 found);
                }
            }
        };
        candidate_ = parallel_collect<Candidate>(runs.size(), kChunk, find);
        std::stable_sort(
            candidate_.begin(), candidate_.end(),
            [](const Candidate& p, const Candidate& q) { return p.height > q.height; });
    }

    void find_in_cell(const SurfaceSamples& samples, CellId cell, const Vec3i& site,
                      std::vector<Candidate>& found) const {
        if (matter_.cell_fill[cell] >= kFull || !lies_by_full(site)) return;
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3i half = corner_step(corner);
            const Vec3 middle = (site.cast<double>() + 0.5 * half.cast<double>()).array() + 0.25;
            const double height =
                samples.height(matter_.lattice.origin + matter_.lattice.spacing * middle);
            if (height <= kOutside) continue;
            const std::array<CellId, 8> beside = cells_beside(site, half);
            if (!all_whole(beside)) continue;
            found.push_back({height, cell, corner, beside});
        }
    }

    std::array<CellId, 8> cells_beside(const Vec3i& site, const Vec3i& half) const {
        std::array<CellId, 8> beside;
        for (int n = 0; n < 8; ++n) {
            const Vec3i at = site + corner_step(n).cwiseProduct(2 * half - Vec3i::Ones());
            beside[n] = matter_.lattice.cell_at(at);
        }
        return beside;
    }

    // No cut runs near.
    bool all_whole(const std::array<CellId, 8>& cells) const {
        return std::all_of(cells.begin(), cells.end(), [&](CellId cell) {
            return cell < 0 || cell_is_whole(matter_, matter_.lattice.cell_row(cell));
        });
    }

    // NOTE: of parts thinner than cells nothing may be left to hold what is taken away.
    bool lies_by_full(const Vec3i& site) const {
        for (int n = 0; n < 27; ++n) {
            const CellId cell = matter_.lattice.cell_at(site + neighbor_step(n));
            if (cell >= 0 && matter_.cell_fill[cell] >= kFull) return true;
        }
        return false;
    }

    bool may_go(const Candidate& candidate) const {
        Around body;
        for (int n = 0; n < 27; ++n) {
            int leaves = 0, bits = 0;
            for (int d = 0, rest = n; d < 3; ++d, rest /= 3) {
                // -1 to 2; in the cell 0 or 1
                const int at = (candidate.corner >> d & 1) + rest % 3 - 1;
                leaves |= (at < 0 || at > 1) << d;
                bits |= (at & 1) << d;
            }
            const CellId cell = candidate.beside[leaves];
            body[n] = cell >= 0 && kept_[cell] >> bits & 1;
        }
        return is_simple(body);
    }

    const Aggregate& matter_;
    std::vector<CornerMask> kept_;
    std::vector<Candidate> candidate_;
};

}  // namespace

std::vector<CornerMask> voxels_to_draw(const Aggregate& matter, const SurfaceSamples& samples) {
    return Thinning(matter, samples).run();
}

}  // namespace swage
