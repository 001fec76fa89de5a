// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cut_surface.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

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
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            if (!is_whole[run.first + n]) continue;
            const Vec3i site(run.i + n, run.j, run.k);
            bool has_face = false;
            for (int face = 0; face < 6; ++face) {
                const int axis = face >> 1, side = face & 1;
                const Vec3i next = site + (side ? 1 : -1) * Vec3i::Unit(axis);
                const CellId other = lattice.cell_at(next.x(), next.y(), next.z());
                if (other < 0 || is_whole[other]) continue;
                has_face = true;
                for (int c = 0; c < 8; ++c) {
                    if ((c >> axis & 1) != side) continue;
                    open.emplace_back(site + Vec3i(c & 1, c >> 1 & 1, c >> 2));
                }
            }
            if (!has_face) continue;
            skin_.push_back(run.first + n);
            site_of_skin.push_back(site);
        }
    }
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
            const CellId cell = lattice.cell_at(at.x(), at.y(), at.z());
            if (cell < 0 || !is_whole[cell] || slot_[cell] >= 0) return;
            slot_[cell] = static_cast<int>(corner_.size());
            corner_.emplace_back();
            for (int c = 0; c < 8; ++c) {
                const auto found = depth.find(key_of(at + Vec3i(c & 1, c >> 1 & 1, c >> 2)));
                corner_.back()[c] = found == depth.end() ? kDeep : found->second;
            }
        });
    }
}

}  // namespace swage
