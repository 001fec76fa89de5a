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

namespace {

// Balls of items, split into eight by the middle of their centres.
class SphereTree {
  public:
    struct Node {
        Vec3 centre = Vec3::Zero();
        double radius = 0;
        int first = 0, count = 0;      // items, in the order of `item`
        int child = -1, children = 0;  // nodes
    };
    SphereTree(std::vector<Vec3> centre, std::vector<double> radius, std::vector<int> items)
        : centre_(std::move(centre)), radius_(std::move(radius)), item_(std::move(items)) {
        if (item_.empty()) return;
        node_.push_back({Vec3::Zero(), 0, 0, static_cast<int>(item_.size())});
        for (std::size_t n = 0; n < node_.size(); ++n) split(static_cast<int>(n));
    }
    const std::vector<Node>& nodes() const { return node_; }
    int item(int n) const { return item_[n]; }

  private:
    static constexpr int kLeaf = 8;

    void split(int n) {
        Box box;
        const int first = node_[n].first, end = first + node_[n].count;
        for (int m = first; m < end; ++m) box.grow(centre_[item_[m]]);
        const Vec3 centre = box.center();
        double radius = 0;
        for (int m = first; m < end; ++m) {
            radius = std::max(radius, (centre_[item_[m]] - centre).norm() + radius_[item_[m]]);
        }
        node_[n].centre = centre;
        node_[n].radius = radius;
        if (end - first <= kLeaf || !(box.high - box.low).maxCoeff()) return;
        const auto octant = [&](int item) {
            const Vec3& c = centre_[item];
            return int(c.x() > centre.x()) | int(c.y() > centre.y()) << 1 |
                   int(c.z() > centre.z()) << 2;
        };
        std::stable_sort(item_.begin() + first, item_.begin() + end,
                         [&](int a, int b) { return octant(a) < octant(b); });
        node_[n].child = static_cast<int>(node_.size());
        for (int m = first; m < end;) {
            int stop = m;
            while (stop < end && octant(item_[stop]) == octant(item_[m])) ++stop;
            node_.push_back({Vec3::Zero(), 0, m, stop - m});
            m = stop;
        }
        node_[n].children = static_cast<int>(node_.size()) - node_[n].child;
    }

    std::vector<Vec3> centre_;
    std::vector<double> radius_;
    std::vector<int> item_;
    std::vector<Node> node_;
};

}  // namespace

std::vector<NearPair> near_pairs_by_spheres(const std::vector<Vec3>& point,
                                            const std::vector<Box>& box) {
    std::vector<int> items;
    for (std::size_t p = 0; p < point.size(); ++p) {
        if (point[p].allFinite()) items.push_back(static_cast<int>(p));
    }
    const SphereTree points(point, std::vector<double>(point.size(), 0.0), items);
    items.clear();
    std::vector<Vec3> centre;
    std::vector<double> radius;
    for (std::size_t b = 0; b < box.size(); ++b) {
        centre.push_back(box[b].center());
        radius.push_back(0.5 * (box[b].high - box[b].low).norm() * (1 + 1e-12));
        if (is_sound(box[b])) items.push_back(static_cast<int>(b));
    }
    const SphereTree boxes(centre, radius, items);
    if (points.nodes().empty() || boxes.nodes().empty()) return {};

    std::vector<NearPair> pair;
    std::vector<std::pair<int, int>> open{{0, 0}};
    while (!open.empty()) {
        const auto [n, m] = open.back();
        open.pop_back();
        const SphereTree::Node &a = points.nodes()[n], &b = boxes.nodes()[m];
        const double reach = a.radius + b.radius;
        if ((a.centre - b.centre).squaredNorm() > reach * reach * (1 + 1e-12)) continue;
        if (a.children == 0 && b.children == 0) {
            for (int p = a.first; p < a.first + a.count; ++p) {
                for (int c = b.first; c < b.first + b.count; ++c) {
                    if (box[boxes.item(c)].contains(point[points.item(p)])) {
                        pair.push_back({points.item(p), boxes.item(c)});
                    }
                }
            }
        } else if (b.children == 0 || (a.children > 0 && a.radius > b.radius)) {
            for (int c = 0; c < a.children; ++c) open.emplace_back(a.child + c, m);
        } else {
            for (int c = 0; c < b.children; ++c) open.emplace_back(n, b.child + c);
        }
    }
    std::sort(pair.begin(), pair.end(), [](const NearPair& a, const NearPair& b) {
        return std::pair(a.point, a.box) < std::pair(b.point, b.box);
    });
    return pair;
}

}  // namespace swage
