// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <tuple>

#include "mold/shares.h"

namespace swage {

namespace {

constexpr int kSides[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

CellFill* find_share(std::vector<CellLayer>& layers, int i, int j, int k) {
    if (k < 0 || k >= static_cast<int>(layers.size())) return nullptr;
    std::vector<CellFill>& shares = layers[k].share;
    const auto at = std::lower_bound(shares.begin(), shares.end(), std::pair(j, i),
                                     [](const CellFill& s, const std::pair<int, int>& site) {
                                         return std::pair(s.j, s.i) < site;
                                     });
    return at != shares.end() && at->i == i && at->j == j ? &*at : nullptr;
}

}  // namespace

double drop_slivers(std::vector<CellLayer>& layers) {
    struct Sliver {
        double fill;
        int i, j, k;
    };
    std::vector<Sliver> slivers;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        for (const CellFill& s : layers[k].share) {
            if (s.fill < kLeastFill) slivers.push_back({s.fill, s.i, s.j, static_cast<int>(k)});
        }
    }
    // From the least on, so that material moves towards the body, over several cells if need be.
    std::sort(slivers.begin(), slivers.end(), [](const Sliver& a, const Sliver& b) {
        return std::tie(a.fill, a.k, a.j, a.i) < std::tie(b.fill, b.k, b.j, b.i);
    });
    double lost = 0;
    for (const Sliver& sliver : slivers) {
        CellFill* share = find_share(layers, sliver.i, sliver.j, sliver.k);
        if (share->fill >= kLeastFill) continue;  // has been given enough
        CellFill* taker = nullptr;
        Vec3 offset;
        for (const auto& [di, dj, dk] : kSides) {
            CellFill* other = find_share(layers, sliver.i + di, sliver.j + dj, sliver.k + dk);
            if (other == nullptr || other->fill == 0) continue;
            if (taker != nullptr && other->fill <= taker->fill) continue;
            taker = other;
            offset = Vec3(di, dj, dk);
        }
        if (share->fill < 0 && (taker == nullptr || taker->fill < -2 * share->fill)) {
            layers[sliver.k].deficit -= share->fill;
        } else if (taker == nullptr) {
            lost += share->fill;
        } else {
            taker->fill += share->fill;
            taker->moment += share->moment - share->fill * offset;
        }
        share->fill = 0;
    }
    for (CellLayer& layer : layers) {
        std::erase_if(layer.share, [](const CellFill& s) { return s.fill == 0; });
    }
    return lost;
}

}  // namespace swage
