// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cut_surface.h"

#include <algorithm>
#include <unordered_map>

#include "matter/open_faces.h"

namespace swage {

namespace {

constexpr int kReach = 2;       // cells that corners are told from
constexpr float kDeep = -2.5f;  // of what lies deeper

template <typename Body>
void around(int reach, const Body& body) {
    for (int k = -reach; k <= reach; ++k) {
        for (int j = -reach; j <= reach; ++j) {
            for (int i = -reach; i <= reach; ++i) body(Vec3i(i, j, k));
        }
    }
}

}  // namespace

CutSurface::CutSurface(const Lattice& lattice, const std::vector<char>& is_whole) {
    slot_.assign(is_whole.size(), -1);
    std::vector<Vec3i> open, site_of_skin;  // corners; cells
    for_each_open_face(lattice, is_whole, [&](const CellRun& run, int n, int face) {
        const Vec3i site(run.i + n, run.j, run.k);
        for (int c = 0; c < 8; ++c) {
            if ((c >> (face >> 1) & 1) != (face & 1)) continue;
            open.emplace_back(site + corner_step(c));
        }
        if (!skin_.empty() && skin_.back() == run.first + n) return;
        skin_.push_back(run.first + n);
        site_of_skin.push_back(site);
    });
    // Once each: up to twelve faces share a corner.
    const auto order = [](const Vec3i& a, const Vec3i& b) { return key_of(a) < key_of(b); };
    std::sort(open.begin(), open.end(), order);
    open.erase(std::unique(open.begin(), open.end()), open.end());
    std::unordered_map<std::uint64_t, float> depth;  // looked up only
    for (const Vec3i& corner : open) {
        around(kReach, [&](const Vec3i& way) {
            const auto far = -0.5f - static_cast<float>(way.cast<double>().norm());
            float& known = depth.try_emplace(key_of(corner + way), kDeep).first->second;
            known = std::max(known, far);
        });
    }
    for (const Vec3i& site : site_of_skin) {
        around(kReach, [&](const Vec3i& way) {
            const Vec3i at = site + way;
            const CellId cell = lattice.cell_at(at);
            if (cell < 0 || !is_whole[cell] || slot_[cell] >= 0) return;
            slot_[cell] = static_cast<int>(corner_.size());
            corner_.emplace_back();
            for (int c = 0; c < 8; ++c) {
                const auto found = depth.find(key_of(at + corner_step(c)));
                corner_.back()[c] = found == depth.end() ? kDeep : found->second;
            }
        });
    }
}

}  // namespace swage
