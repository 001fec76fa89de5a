// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <tuple>

#include "mold/shares.h"

namespace swage {

namespace {

constexpr int kSides[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

// Of a layer, where that of the cell stands or would stand.
template <typename Shares>
auto place_of(Shares& shares, int i, int j) {
    return std::lower_bound(shares.begin(), shares.end(), std::pair(j, i),
                            [](const CellFill& s, const std::pair<int, int>& site) {
                                return std::pair(s.j, s.i) < site;
                            });
}

template <typename Layers>
auto find_share(Layers& layers, int i, int j, int k) -> decltype(&*layers[0].share.begin()) {
    if (k < 0 || k >= static_cast<int>(layers.size())) return nullptr;
    const auto at = place_of(layers[k].share, i, j);
    return at != layers[k].share.end() && at->i == i && at->j == j ? &*at : nullptr;
}

void give(const CellFill& share, const Vec3& offset, CellFill& taker) {
    taker.fill += share.fill;
    taker.moment += share.moment - share.fill * offset;
}

}  // namespace

const CellFill* share_of(const std::vector<CellLayer>& layers, int i, int j, int k) {
    return find_share(layers, i, j, k);
}

void move_slivers(const std::vector<SliverMove>& moves, std::vector<CellLayer>& layers) {
    for (const auto& [from, to] : moves) {
        const CellFill* share = find_share(layers, from.x(), from.y(), from.z());
        if (share == nullptr) continue;
        const CellFill moved = *share;
        CellFill* taker = find_share(layers, to.x(), to.y(), to.z());
        if (taker == nullptr) {
            std::vector<CellFill>& shares = layers[to.z()].share;
            taker = &*shares.insert(place_of(shares, to.x(), to.y()),
                                    {to.x(), to.y(), 0, Vec3::Zero()});
        }
        give(moved, (to - from).cast<double>(), *taker);
        find_share(layers, from.x(), from.y(), from.z())->fill = 0;
    }
}

double drop_slivers(std::vector<CellLayer>& layers, std::vector<SliverMove>* moves) {
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
        Vec3i offset;
        for (const auto& [di, dj, dk] : kSides) {
            CellFill* other = find_share(layers, sliver.i + di, sliver.j + dj, sliver.k + dk);
            if (other == nullptr || other->fill == 0) continue;
            if (taker != nullptr && other->fill <= taker->fill) continue;
            taker = other;
            offset = Vec3i(di, dj, dk);
        }
        if (share->fill < 0 && (taker == nullptr || taker->fill < -2 * share->fill)) {
            layers[sliver.k].deficit -= share->fill;
        } else if (taker == nullptr) {
            lost += share->fill;
        } else {
            give(*share, offset.cast<double>(), *taker);
            const Vec3i from(sliver.i, sliver.j, sliver.k);
            if (moves != nullptr) moves->push_back({from, from + offset});
        }
        share->fill = 0;
    }
    for (CellLayer& layer : layers) {
        std::erase_if(layer.share, [](const CellFill& s) { return s.fill == 0; });
    }
    return lost;
}

}  // namespace swage
