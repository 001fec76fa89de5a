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

struct Voxel {
    CellId cell;  // -1: none
    int corner;
};

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
                kept_[candidate.at.cell] &= static_cast<CornerMask>(~(1 << candidate.at.corner));
                candidate.gone = any = true;
            }
        }
        return std::move(kept_);
    }

  private:
    struct Candidate {
        double height;  // of its middle above the surface, in spacings
        Voxel at;
        Vec3i site;  // of its cell
        bool gone;
    };

    // The farthest out first.
    void find_outside(const SurfaceSamples& samples) {
        const std::vector<CellRun>& runs = matter_.lattice.cell_run;
        std::vector<std::vector<Candidate>> found((runs.size() + kChunk - 1) / kChunk);
        parallel_for(found.size(), [&](std::size_t chunk) {
            const std::size_t end = std::min(runs.size(), (chunk + 1) * kChunk);
            for (std::size_t r = chunk * kChunk; r < end; ++r) {
                for (int n = 0; n < runs[r].count; ++n) {
                    find_in_cell(samples, runs[r].first + n, {runs[r].i + n, runs[r].j, runs[r].k},
                                 found[chunk]);
                }
            }
        });
        for (const auto& part : found) {
            candidate_.insert(candidate_.end(), part.begin(), part.end());
        }
        std::stable_sort(
            candidate_.begin(), candidate_.end(),
            [](const Candidate& p, const Candidate& q) { return p.height > q.height; });
    }

    void find_in_cell(const SurfaceSamples& samples, CellId cell, const Vec3i& site,
                      std::vector<Candidate>& found) const {
        if (matter_.cell_fill[cell] >= kFull || !lies_by_full(site) ||
            !is_whole(matter_, matter_.lattice.cell_corners(cell))) {
            return;
        }
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 half(corner & 1, corner >> 1 & 1, corner >> 2);
            const Vec3 middle = site.cast<double>() + Vec3::Constant(0.25) + 0.5 * half;
            const double height =
                samples.height(matter_.lattice.origin + matter_.lattice.spacing * middle);
            if (height > kOutside) found.push_back({height, {cell, corner}, site, false});
        }
    }

    // NOTE: of parts thinner than cells nothing may be left to hold what is taken away.
    bool lies_by_full(const Vec3i& site) const {
        for (int n = 0; n < 27; ++n) {
            const Vec3i at = site + Vec3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
            const CellId cell = matter_.lattice.cell_at(at.x(), at.y(), at.z());
            if (cell >= 0 && matter_.cell_fill[cell] >= kFull) return true;
        }
        return false;
    }

    bool may_go(const Candidate& candidate) const {
        std::array<Voxel, 27> around;
        find_around(candidate, around);
        if (has_cut(around)) return false;
        Around body;
        for (int n = 0; n < 27; ++n) body[n] = around[n].cell >= 0;
        return is_simple(body);
    }

    // Of neighbours along an axis, both there: whether they hang together.
    bool joined(const Voxel& low, const Voxel& high, int axis) const {
        if (low.cell != high.cell) return true;
        const auto row = matter_.lattice.cell_row(low.cell);
        return matter_.connection[axis].weight[row[low.corner >> 1] + (low.corner & 1)] > 0;
    }

    bool has_cut(const std::array<Voxel, 27>& around) const {
        for (int n = 0; n < 27; ++n) {
            for (int axis = 0, step = 1; axis < 3; ++axis, step *= 3) {
                if (n / step % 3 == 2) continue;
                const Voxel &low = around[n], &high = around[n + step];
                if (low.cell >= 0 && high.cell >= 0 && !joined(low, high, axis)) return true;
            }
        }
        return false;
    }

    void find_around(const Candidate& candidate, std::array<Voxel, 27>& around) const {
        const int corner = candidate.at.corner;
        // The eight cells that they lie in: its own and those at its corner.
        std::array<CellId, 8> cell;
        for (int n = 0; n < 8; ++n) {
            Vec3i site = candidate.site;
            for (int d = 0; d < 3; ++d) {
                if (n >> d & 1) site[d] += corner >> d & 1 ? 1 : -1;
            }
            cell[n] = matter_.lattice.cell_at(site.x(), site.y(), site.z());
        }
        for (int n = 0; n < 27; ++n) {
            int which = 0, bits = 0;
            for (int d = 0, rest = n; d < 3; ++d, rest /= 3) {
                const int at = (corner >> d & 1) + rest % 3 - 1;  // -1 to 2; in the cell 0 or 1
                which |= (at < 0 || at > 1) << d;
                bits |= (at & 1) << d;
            }
            const bool there = cell[which] >= 0 && kept_[cell[which]] >> bits & 1;
            around[n] = {there ? cell[which] : -1, bits};
        }
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
