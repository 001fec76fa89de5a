// SPDX-License-Identifier: GPL-3.0-or-later
// Points in boxes by trees of spheres (S0.9), against which geometry/near_pairs.h is tested and
// timed.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/near_pairs.h"

namespace swage::test {

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

// As near_pairs().
inline std::vector<NearPair> near_pairs_by_spheres(const std::vector<Vec3>& point,
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
        const bool is_sound = box[b].low.allFinite() && box[b].high.allFinite() && !box[b].empty();
        if (is_sound) items.push_back(static_cast<int>(b));
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

}  // namespace swage::test
