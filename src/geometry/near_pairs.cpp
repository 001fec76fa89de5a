// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/near_pairs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace swage {

namespace {

bool is_sound(const Box& box) {
    return box.low.allFinite() && box.high.allFinite() && !box.empty();
}

// The pairs of each point in a row, in the order in which they came.
std::vector<NearPair> sorted_by_point(const std::vector<NearPair>& pair, std::size_t points) {
    std::vector<int> begin(points + 1, 0);
    for (const NearPair& one : pair) ++begin[one.point + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<NearPair> sorted(pair.size());
    for (const NearPair& one : pair) sorted[begin[one.point]++] = one;
    return sorted;
}

using Bin = std::array<std::int32_t, 3>;

// Bins as wide as a box is on average, counted from the corner of all.
struct BinGrid {
    Box all;  // of the sound boxes; empty: there is none
    double width = 0;

    explicit BinGrid(const std::vector<Box>& box) {
        std::size_t sound = 0;
        for (const Box& one : box) {
            if (!is_sound(one)) continue;
            all.grow(one);
            width += (one.high - one.low).maxCoeff();
            ++sound;
        }
        if (sound == 0) return;
        width /= static_cast<double>(sound);
        // 2^20 of them along any side are enough.
        width = std::max(width, (all.high - all.low).maxCoeff() / double(1 << 20));
        if (!(width > 0)) width = 1;
    }
    Bin bin_of(const Vec3& p) const {
        Bin bin;
        for (int d = 0; d < 3; ++d) {
            bin[d] = static_cast<std::int32_t>(std::floor((p[d] - all.low[d]) / width));
        }
        return bin;
    }
};

// The points that may lie in a box, by the bins that they lie in.
class BinnedPoints {
  public:
    BinnedPoints(const std::vector<Vec3>& point, const BinGrid& grid) : grid_(grid) {
        std::vector<int> near;
        for (std::size_t p = 0; p < point.size(); ++p) {
            if (grid.all.contains(point[p])) near.push_back(static_cast<int>(p));
        }
        if (near.empty()) return;
        buckets_ = std::bit_ceil(2 * near.size());
        std::vector<Bin> bin;
        begin_.assign(buckets_ + 1, 0);
        for (int p : near) {
            bin.push_back(grid.bin_of(point[p]));
            ++begin_[bucket(bin.back()) + 1];
        }
        std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
        binned_.resize(near.size());
        std::vector<int> next(begin_.begin(), begin_.end() - 1);
        for (std::size_t n = 0; n < near.size(); ++n) {
            binned_[next[bucket(bin[n])]++] = {point[near[n]], bin[n], near[n]};
        }
    }
    bool empty() const { return binned_.empty(); }

    // Adds those in a sound box.
    void add_within(const Box& box, int id, std::vector<NearPair>& pair) const {
        const Bin low = grid_.bin_of(box.low), high = grid_.bin_of(box.high);
        double bins = 1;
        for (int d = 0; d < 3; ++d) bins *= high[d] - low[d] + 1.0;
        if (bins > static_cast<double>(binned_.size())) {
            for (const Binned& one : binned_) {
                if (box.contains(one.at)) pair.push_back({one.point, id});
            }
            return;
        }
        for (std::int32_t k = low[2]; k <= high[2]; ++k) {
            for (std::int32_t j = low[1]; j <= high[1]; ++j) {
                for (std::int32_t i = low[0]; i <= high[0]; ++i) {
                    const Bin here{i, j, k};
                    const std::size_t at = bucket(here);
                    for (int n = begin_[at]; n < begin_[at + 1]; ++n) {
                        if (box.contains(binned_[n].at) && binned_[n].bin == here) {
                            pair.push_back({binned_[n].point, id});
                        }
                    }
                }
            }
        }
    }

  private:
    std::size_t bucket(const Bin& bin) const {
        std::uint64_t h = static_cast<std::uint32_t>(bin[0]) * 0x9E3779B97F4A7C15ull;
        h ^= static_cast<std::uint32_t>(bin[1]) * 0xC2B2AE3D27D4EB4Full;
        h ^= static_cast<std::uint32_t>(bin[2]) * 0x165667B19E3779F9ull;
        return (h ^ (h >> 29)) & (buckets_ - 1);
    }

    const BinGrid& grid_;
    std::size_t buckets_ = 0;
    // By bucket, for boxes go through them side by side.
    struct Binned {
        Vec3 at;
        Bin bin;
        int point;
    };
    std::vector<Binned> binned_;
    std::vector<int> begin_;  // of each bucket; the end
};

}  // namespace

std::vector<NearPair> near_pairs(const std::vector<Vec3>& point, const std::vector<Box>& box) {
    const BinGrid grid(box);
    if (grid.all.empty()) return {};
    const BinnedPoints binned(point, grid);
    if (binned.empty()) return {};
    std::vector<NearPair> pair;
    for (std::size_t b = 0; b < box.size(); ++b) {
        if (is_sound(box[b])) binned.add_within(box[b], static_cast<int>(b), pair);
    }
    return sorted_by_point(pair, point.size());
}

}  // namespace swage
