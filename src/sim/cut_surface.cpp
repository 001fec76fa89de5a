// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cut_surface.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "matter/cut_planes.h"
#include "matter/open_faces.h"

namespace swage {

namespace {

constexpr int kReach = 2;        // cells that corners are told from
constexpr float kDeep = -2.5f;   // of what lies deeper
constexpr double kTouch = 1e-3;  // cells that a plane may seem to go into one beside it

using Depths = std::unordered_map<std::uint64_t, float>;  // of corners; looked up only

template <typename Body>
void around(int reach, const Body& body) {
    for (int k = -reach; k <= reach; ++k) {
        for (int j = -reach; j <= reach; ++j) {
            for (int i = -reach; i <= reach; ++i) body(Vec3i(i, j, k));
        }
    }
}

}  // namespace

CutSurface::CutSurface(const Aggregate& matter, const std::vector<char>& is_whole) {
    const Lattice& lattice = matter.lattice;
    const CutPlanes cuts(matter);
    slot_.assign(is_whole.size(), -1);
    std::vector<Vec3i> open, parted, site_of_skin;  // corners before breaks, before cuts; cells
    for_each_open_face(lattice, is_whole, [&](const CellRun& run, int n, int face) {
        const Vec3i site(run.i + n, run.j, run.k);
        std::vector<Vec3i>& corners = cut_before(matter, cuts, site, face) ? parted : open;
        for (int c = 0; c < 8; ++c) {
            if ((c >> (face >> 1) & 1) != (face & 1)) continue;
            corners.emplace_back(site + corner_step(c));
        }
        if (!skin_.empty() && skin_.back() == run.first + n) return;
        skin_.push_back(run.first + n);
        site_of_skin.push_back(site);
    });
    // Once each: up to twelve faces share a corner.
    const auto by_key = [](const Vec3i& a, const Vec3i& b) { return key_of(a) < key_of(b); };
    for (std::vector<Vec3i>* corners : {&open, &parted}) {
        std::sort(corners->begin(), corners->end(), by_key);
        corners->erase(std::unique(corners->begin(), corners->end()), corners->end());
    }
    const auto rise = [](Depths& depth, const Vec3i& corner, double to) {
        float& known = depth.try_emplace(key_of(corner), kDeep).first->second;
        known = std::max(known, static_cast<float>(to));
    };
    Depths broken;
    for (const Vec3i& corner : open) {
        around(kReach, [&](const Vec3i& way) {
            rise(broken, corner + way, -0.5 - way.cast<double>().norm());
        });
    }
    Depths all = broken;
    std::vector<std::vector<CutPlane>> near;  // of each parted corner
    for (const Vec3i& corner : parted) {
        near.push_back(cuts.around(corner.cast<double>()));
        around(kReach, [&](const Vec3i& way) {
            const Vec3i at = corner + way;
            for (const CutPlane& plane : near.back()) {
                rise(all, at, -plane.distance(at.cast<double>()));
            }
        });
    }
    PathsAtCorners paths(cuts);
    for (const Vec3i& site : site_of_skin) {
        around(kReach, [&](const Vec3i& way) {
            const Vec3i at = site + way;
            const CellId cell = lattice.cell_at(at);
            if (cell < 0 || !is_whole[cell] || slot_[cell] >= 0) return;
            slot_[cell] = static_cast<int>(corner_.size());
            std::vector<CutPlane> beside;
            for (int c = 0; c < 8; ++c) {
                const Vec3i corner = at + corner_step(c);
                const auto known = std::lower_bound(parted.begin(), parted.end(), corner, by_key);
                if (known == parted.end() || *known != corner) continue;
                const std::vector<CutPlane>& more = near[std::size_t(known - parted.begin())];
                beside.insert(beside.end(), more.begin(), more.end());
            }
            plane_.emplace_back();
            bent_of_.push_back(-1);
            if (std::ranges::all_of(beside, &CutPlane::is_flat)) {
                plane_.back() = planes_of(at, beside);
            } else {
                bent_of_.back() = bent_.add(at, beside, paths);
            }
            const bool is_told = !plane_.back().empty() || bent_of_.back() >= 0;
            const Depths& depth = is_told ? broken : all;
            corner_.emplace_back();
            for (int c = 0; c < 8; ++c) {
                const auto found = depth.find(key_of(at + corner_step(c)));
                corner_.back()[c] = found == depth.end() ? kDeep : found->second;
            }
        });
    }
    bent_.add_beside(lattice, is_whole, paths);
}

// Of each direction the nearest. None where one would go through the cell, as a path that ends
// before it does.
std::vector<CutSurface::Plane> CutSurface::planes_of(const Vec3i& site,
                                                     const std::vector<CutPlane>& near) {
    const Vec3 low = site.cast<double>(), half = Vec3::Constant(0.5);
    std::vector<Plane> planes;
    for (const CutPlane& cut : near) {
        const double side = (low + half - cut.place).dot(cut.normal) < 0 ? 1 : -1;
        const Plane plane{side * cut.normal, side * cut.normal.dot(low - cut.place)};
        const Vec3 n = plane.normal;
        if (plane.depth + n.cwiseMax(0.0).sum() > kTouch) continue;
        const auto like = std::ranges::find_if(
            planes, [&](const Plane& known) { return known.normal.dot(n) > kOneWay; });
        if (like == planes.end()) {
            planes.push_back(plane);
        } else if (plane.depth + n.dot(half) > like->depth + like->normal.dot(half)) {
            *like = plane;
        }
    }
    return planes;
}

CutSurface::CutSurface(std::vector<std::vector<Plane>> planes) : plane_(std::move(planes)) {
    std::array<float, 8> deep;
    deep.fill(kDeep);
    corner_.assign(plane_.size(), deep);
    bent_of_.assign(plane_.size(), -1);
    for (std::size_t cell = 0; cell < plane_.size(); ++cell) {
        slot_.push_back(plane_[cell].empty() ? -1 : static_cast<int>(cell));
        if (slot_.back() >= 0) skin_.push_back(static_cast<CellId>(cell));
    }
}

RestSurface::Depth CutSurface::at(CellId cell, const Vec3& place, const Vec3& met) const {
    RestSurface::Depth depth = interpolate_depth(corner_[slot_[cell]], place);
    for (const Plane& plane : plane_[slot_[cell]]) {
        const double far = plane.depth + plane.normal.dot(place);
        if (far > depth.distance && !is_opposed(plane.normal, met)) depth = {far, plane.normal};
    }
    if (bent_of_[slot_[cell]] < 0) return depth;
    const RestSurface::Depth bent = bent_.at(bent_of_[slot_[cell]], place);
    return bent.distance > depth.distance ? bent : depth;
}

}  // namespace swage
