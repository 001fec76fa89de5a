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

std::uint64_t bucket_of(const Bin& bin) {
    std::uint64_t h = static_cast<std::uint32_t>(bin[0]) * 0x9E3779B97F4A7C15ull;
    h ^= static_cast<std::uint32_t>(bin[1]) * 0xC2B2AE3D27D4EB4Full;
    h ^= static_cast<std::uint32_t>(bin[2]) * 0x165667B19E3779F9ull;
    return h ^ (h >> 29);
}

}  // namespace

std::vector<NearPair> near_pairs(const std::vector<Vec3>& point, const std::vector<Box>& box) {
    Box all;
    double width = 0;
    std::size_t sound = 0;
    for (const Box& one : box) {
        if (!is_sound(one)) continue;
        all.grow(one);
        width += (one.high - one.low).maxCoeff();
        ++sound;
    }
    if (sound == 0) return {};
    width /= static_cast<double>(sound);
    // Bins are counted from the boxes' own corner; 2^20 of them along any side are enough.
    width = std::max(width, (all.high - all.low).maxCoeff() / double(1 << 20));
    if (!(width > 0)) width = 1;
    const auto bin_of = [&](const Vec3& p) {
        Bin bin;
        for (int d = 0; d < 3; ++d) {
            bin[d] = static_cast<std::int32_t>(std::floor((p[d] - all.low[d]) / width));
        }
        return bin;
    };

    std::vector<int> near;
    for (std::size_t p = 0; p < point.size(); ++p) {
        if (all.contains(point[p])) near.push_back(static_cast<int>(p));
    }
    if (near.empty()) return {};
    const std::size_t buckets = std::bit_ceil(2 * near.size());
    const auto hashed = [&](const Bin& bin) { return bucket_of(bin) & (buckets - 1); };
    std::vector<Bin> bin;
    std::vector<int> begin(buckets + 1, 0);
    for (int p : near) {
        bin.push_back(bin_of(point[p]));
        ++begin[hashed(bin.back()) + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    // By bucket, for boxes go through them side by side.
    struct Binned {
        Vec3 at;
        Bin bin;
        int point;
    };
    std::vector<Binned> binned(near.size());
    std::vector<int> next(begin.begin(), begin.end() - 1);
    for (std::size_t n = 0; n < near.size(); ++n) {
        binned[next[hashed(bin[n])]++] = {point[near[n]], bin[n], near[n]};
    }

    std::vector<NearPair> pair;
    for (std::size_t b = 0; b < box.size(); ++b) {
        if (!is_sound(box[b])) continue;
        const int id = static_cast<int>(b);
        const Bin low = bin_of(box[b].low), high = bin_of(box[b].high);
        double bins = 1;
        for (int d = 0; d < 3; ++d) bins *= high[d] - low[d] + 1.0;
        if (bins > static_cast<double>(near.size())) {
            for (int p : near) {
                if (box[b].contains(point[p])) pair.push_back({p, id});
            }
            continue;
        }
        for (std::int32_t k = low[2]; k <= high[2]; ++k) {
            for (std::int32_t j = low[1]; j <= high[1]; ++j) {
                for (std::int32_t i = low[0]; i <= high[0]; ++i) {
                    const Bin here{i, j, k};
                    const std::size_t at = hashed(here);
                    for (int n = begin[at]; n < begin[at + 1]; ++n) {
                        if (box[b].contains(binned[n].at) && binned[n].bin == here) {
                            pair.push_back({binned[n].point, id});
                        }
                    }
                }
            }
        }
    }
    return sorted_by_point(pair, point.size());
}

}  // namespace swage
