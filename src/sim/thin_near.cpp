// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/thin_near.h"

#include <algorithm>

#include "matter/particle_site.h"

namespace swage {

namespace {

constexpr int kBin = 4;  // cells

std::uint64_t bin_of(const Vec3i& cell) {
    const auto bin = [](int at) { return at >= 0 ? at / kBin : -((kBin - 1 - at) / kBin); };
    return key_of({bin(cell.x()), bin(cell.y()), bin(cell.z())});
}

}  // namespace

void CellBins::add(const Vec3i& cell) { at_.emplace_back(bin_of(cell), count_++); }

void CellBins::sort() { std::sort(at_.begin(), at_.end()); }

std::vector<int> CellBins::around(const std::vector<Vec3i>& sites, int low, int high) const {
    std::vector<std::uint64_t> bins;
    for (const Vec3i& site : sites) {
        for (int c = 0; c < 8; ++c) {  // of a box that is no wider than a bin
            const Vec3i far = Vec3i::Constant(low) + (high - low) * Vec3i(corner_step(c));
            bins.push_back(bin_of(site + far));
        }
    }
    std::sort(bins.begin(), bins.end());
    bins.erase(std::unique(bins.begin(), bins.end()), bins.end());
    std::vector<int> found;
    for (std::uint64_t bin : bins) {
        for (auto at = std::lower_bound(at_.begin(), at_.end(), std::pair{bin, 0});
             at != at_.end() && at->first == bin; ++at) {
            found.push_back(at->second);
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

ThinNear::ThinNear(const Aggregate& of) {
    for (const CutPoint& at : of.cut) {
        cut.add(Vec3(at.place[0], at.place[1], at.place[2]).array().floor().cast<int>());
    }
    cut.sort();
    for (std::size_t p = 0; p < of.surface.size(); ++p) {
        // None is loose as molded, or nearly: where such a one is counted does not matter.
        point.add(lattice_site(of, of.surface.row(p)[0]));
    }
    point.sort();
}

}  // namespace swage
