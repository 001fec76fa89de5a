// SPDX-License-Identifier: GPL-3.0-or-later
// What of the surface faces what, in one cell or in cells that share a corner, has matter behind it
// that the lattice joins. The mesh joins it too if the surface does within the cells around.
#include "mold/filled_gaps.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "geometry/disjoint_sets.h"
#include "mold/surface_pieces.h"

namespace swage {

namespace {

constexpr double kTouch = 1e-6;  // [cells]
// Walls that open by more than 60 degrees are two cells apart within two cells of their root.
constexpr double kOpposed = -0.5;  // most that the product of their normals may be
constexpr double kNarrows = 0.5;   // of its width: where it has less, it closes up

bool is_opposite(const Vec3& way, const Vec3& normal, const Vec3& other, double slack) {
    return normal.dot(other) < kOpposed && way.dot(normal) > -slack && way.dot(other) < slack;
}

// Cells that the surface passes, layer by layer, row by row.
class SurfaceCells {
  public:
    SurfaceCells(const std::vector<CellLayer>& layers, const MoldFrame& frame)
        : layers_(layers), count_(frame.cell_count), row_(layers.size()) {
        parallel_for(layers.size(), [&](std::size_t k) {
            const std::vector<SurfacePatch>& patch = layers[k].patch;
            row_[k].assign(static_cast<std::size_t>(count_.y()) + 1, 0);
            for (const SurfacePatch& p : patch) ++row_[k][p.j + 1];
            for (int j = 0; j < count_.y(); ++j) row_[k][j + 1] += row_[k][j];
        });
    }

    // Those of a layer that hold matter and whose surface may face that of others around.
    std::vector<Vec3i> facing(int k) const {
        std::vector<Vec3i> found;
        const std::vector<SurfacePatch>& patch = layers_[k].patch;
        for (std::size_t begin = 0, end = 0; begin < patch.size(); begin = end) {
            const Vec3i cell(patch[begin].i, patch[begin].j, k);
            while (end < patch.size() && patch[end].i == cell.x() && patch[end].j == cell.y())
                ++end;
            if (faces(cell, &patch[begin], &patch[0] + end) &&
                share_of(layers_, cell.x(), cell.y(), k) != nullptr) {
                found.push_back(cell);
            }
        }
        return found;
    }

  private:
    bool faces(const Vec3i& cell, const SurfacePatch* first, const SurfacePatch* last) const {
        for (int k = cell.z() - 1; k <= cell.z() + 1; ++k) {
            if (k < 0 || k >= count_.z()) continue;
            for (int j = cell.y() - 1; j <= cell.y() + 1; ++j) {
                if (j < 0 || j >= count_.y()) continue;
                const SurfacePatch* const all = layers_[k].patch.data();
                const SurfacePatch* other =
                    std::lower_bound(all + row_[k][j], all + row_[k][j + 1], cell.x() - 1,
                                     [](const SurfacePatch& p, int i) { return p.i < i; });
                for (; other < all + row_[k][j + 1] && other->i <= cell.x() + 1; ++other) {
                    for (const SurfacePatch* one = first; one < last; ++one) {
                        // NOTE: a patch is a mean of what lies in a bin, which may be several.
                        if (is_opposite(other->center - one->center, one->normal, other->normal, 1))
                            return true;
                    }
                }
            }
        }
        return false;
    }

    const std::vector<CellLayer>& layers_;
    const Vec3i& count_;
    std::vector<std::vector<std::size_t>> row_;  // first patch of each, and the end
};

std::vector<Vec3i> with_those_around(const std::vector<Vec3i>& cells) {
    std::vector<Vec3i> all;
    all.reserve(27 * cells.size());
    for (const Vec3i& c : cells) {
        for (int n = 0; n < 27; ++n) {
            all.push_back(c + Vec3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
        }
    }
    std::sort(all.begin(), all.end(), comes_before);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

struct Pair {
    int from, to;  // patches
    bool apart;    // they do not hang together around the first
    auto operator<=>(const Pair&) const = default;
};

// Of patches that face each other and have matter.
std::vector<Pair> facing_pairs(const SurfacePieces& pieces, const std::vector<Vec3i>& facing) {
    const std::vector<FacingPatch>& patch = pieces.patches();
    // Those of each cell.
    std::vector<std::pair<std::size_t, std::size_t>> range;
    std::size_t end = 0;
    for (const Vec3i& cell : facing) {
        while (end < patch.size() && comes_before(pieces.cell_of(patch[end]), cell)) ++end;
        const std::size_t begin = end;
        while (end < patch.size() && pieces.cell_of(patch[end]) == cell) ++end;
        range.emplace_back(begin, end);
    }
    const auto of_cells = [&](std::size_t begin, std::size_t end) {
        std::vector<Pair> pairs;
        for (std::size_t n = begin; n < end; ++n) {
            const Vec3i& cell = facing[n];
            std::vector<std::size_t> others;
            for (int around = 0; around < 27; ++around) {
                const Vec3i c = cell + Vec3i(around % 3 - 1, around / 3 % 3 - 1, around / 9 - 1);
                const auto at = std::lower_bound(facing.begin(), facing.end(), c, comes_before);
                if (at == facing.end() || *at != c) continue;
                const auto& [from, to] = range[static_cast<std::size_t>(at - facing.begin())];
                for (std::size_t q = from; q < to; ++q) others.push_back(q);
            }
            std::vector<int> joined;
            for (std::size_t p = range[n].first; p < range[n].second; ++p) {
                if (joined.empty() || joined[0] != patch[p].piece) {
                    joined = pieces.joined_around(patch[p].piece);
                }
                for (std::size_t q : others) {
                    if (!is_opposite(patch[q].center - patch[p].center, patch[p].normal,
                                     patch[q].normal, kTouch))
                        continue;
                    const bool apart =
                        std::find(joined.begin(), joined.end(), patch[q].piece) == joined.end();
                    pairs.push_back({static_cast<int>(p), static_cast<int>(q), apart});
                }
            }
        }
        return pairs;
    };
    std::vector<Pair> all;
    for (const std::vector<Pair>& some : parallel_parts(facing.size(), 256, of_cells)) {
        all.insert(all.end(), some.begin(), some.end());
    }
    std::sort(all.begin(), all.end());
    return all;
}

// Of a patch, to what faces it nearest.
struct Reach {
    int patch;
    Vec3 middle;   // [cells]
    double width;  // [cells]
    double least;  // of what its sides have nearby, where they hang together too
    double open;   // the spacing that keeps so much open [cells]
};

FilledGap gap_of(std::vector<Reach> reach, const std::vector<FacingPatch>& patch,
                 const MoldFrame& frame) {
    double area = 0, open = std::numeric_limits<double>::infinity(), least = reach[0].least;
    Vec3 moment = Vec3::Zero();
    for (const Reach& r : reach) {
        area += patch[r.patch].area, moment += patch[r.patch].area * r.middle;
        open = std::min(open, r.least * r.open / r.width), least = std::min(least, r.least);
    }
    const auto middle = reach.begin() + static_cast<std::ptrdiff_t>(reach.size() / 2);
    std::nth_element(reach.begin(), middle, reach.end(),
                     [](const Reach& a, const Reach& b) { return a.width < b.width; });
    const double width = middle->width;
    const bool stays = width > kTouch && least > kNarrows * width;
    return {frame.point(2 * moment / area), width > kTouch ? width * frame.spacing : 0, area / 2,
            stays ? open * frame.spacing : 0};
}

}  // namespace

std::vector<FilledGap> filled_gaps(const TriMesh& mesh, const std::vector<CellLayer>& layers,
                                   const MoldFrame& frame) {
    const SurfaceCells surface(layers, frame);
    std::vector<std::vector<Vec3i>> of_layer(layers.size());
    parallel_for(layers.size(),
                 [&](std::size_t k) { of_layer[k] = surface.facing(static_cast<int>(k)); });
    std::vector<Vec3i> facing;
    for (const std::vector<Vec3i>& cells : of_layer) {
        facing.insert(facing.end(), cells.begin(), cells.end());
    }
    if (facing.empty()) return {};

    const SurfacePieces pieces(mesh, frame, with_those_around(facing));
    const std::vector<FacingPatch>& patch = pieces.patches();
    const std::vector<Pair> pairs = facing_pairs(pieces, facing);
    DisjointSets groups(patch.size());
    std::vector<Reach> reach;
    std::vector<double> closest(pieces.count(), std::numeric_limits<double>::infinity());
    for (const Pair& pair : pairs) {
        const FacingPatch &one = patch[pair.from], &other = patch[pair.to];
        const Vec3 way = other.center - one.center;
        const double width = 0.5 * way.dot(one.normal - other.normal);
        closest[one.piece] = std::min(closest[one.piece], width);
        if (!pair.apart ||
            !std::binary_search(pairs.begin(), pairs.end(), Pair{pair.to, pair.from, true}))
            continue;
        groups.unite(pair.from, pair.to);
        if (reach.empty() || reach.back().patch != pair.from) {
            reach.push_back(
                {pair.from, Vec3::Zero(), std::numeric_limits<double>::infinity(), 0, 0});
        }
        Reach& best = reach.back();
        if (width >= best.width) continue;
        // Along each axis the lattice joins what is two cells apart.
        best = {pair.from, 0.5 * (one.center + other.center), width, width,
                width / (2 * one.normal.lpNorm<1>())};
    }
    std::vector<int> piece_patch(pieces.count(), -1);
    // A gap goes on where the surface of its sides does.
    for (const Reach& r : reach) {
        int& known = piece_patch[patch[r.patch].piece];
        if (known < 0) known = r.patch;
        groups.unite(known, r.patch);
    }
    for (Reach& r : reach) {
        r.least = std::min(r.least, closest[patch[r.patch].piece]);
        for (int next : pieces.next_to(patch[r.patch].piece)) {
            r.least = std::min(r.least, closest[next]);
            if (piece_patch[next] >= 0) groups.unite(piece_patch[next], r.patch);
        }
    }
    std::vector<int> number;
    std::vector<std::vector<Reach>> of_group(static_cast<std::size_t>(groups.number_sets(number)));
    for (const Reach& r : reach) of_group[number[r.patch]].push_back(r);
    std::vector<FilledGap> gaps;
    for (std::vector<Reach>& group : of_group) {
        if (!group.empty()) gaps.push_back(gap_of(std::move(group), patch, frame));
    }
    std::ranges::stable_sort(gaps, std::greater<>(), &FilledGap::area);
    return gaps;
}

}  // namespace swage
