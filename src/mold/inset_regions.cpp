// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/inset_regions.h"

#include <limits>

#include "geometry/box_mesh.h"
#include "geometry/clip_mesh.h"
#include "geometry/mesh_unite.h"

namespace swage {

namespace {

// Of one inset; where others divide it further, what it shares with the next is not known.
constexpr std::size_t kMostRegions = 100;
// At one place: no more than cells can hold, and as many as can be waited for.
constexpr std::size_t kMostMeshes = 3;

Box everywhere() {
    const Vec3 far = Vec3::Constant(std::numeric_limits<double>::infinity());
    return {-far, far};
}

Box common_box(const Box& a, const Box& b) {
    return {a.low.cwiseMax(b.low), a.high.cwiseMin(b.high)};
}

bool holds_nothing(const Box& box) { return !(box.low.array() < box.high.array()).all(); }

}  // namespace

InsetRegions::InsetRegions(const TriMesh& body, const std::vector<Inset>& insets)
    : insets_(insets) {
    std::optional<TriMesh>& whole = surface_[{}];
    whole.emplace();
    whole->position = body.position;
    whole->triangle = body.triangle;
}

void InsetRegions::add(int inset, bool inside) {
    const TriMesh& solid = insets_[inset].solid;
    box_.push_back(box_it_is(solid));
    bounds_.push_back(box_of(solid.position));
    if (inside && !box_.back()) surface_[{inset}] = solid;
    had_ = has_;
    for (std::vector<Region>& regions : has_) give_way(inset, regions);
    has_.push_back({all_of(inset)});
}

std::optional<TriMesh> InsetRegions::in_body() {
    const Region region = all_of(static_cast<int>(box_.size()) - 1);
    const std::optional<TriMesh>& surface = surface_of(region.meshes);
    if (!surface) return std::nullopt;
    return clipped_to_box(*surface, region.box);
}

std::optional<std::vector<InsetRegions::Signed>> InsetRegions::taken_from(int older) {
    const int inset = static_cast<int>(box_.size()) - 1;
    if (had_[older].size() > kMostRegions) return std::nullopt;
    std::vector<Region> shared;
    for (const Region& region : had_[older]) {
        const Region both = common(region, inset);
        if (holds_nothing(both.box)) continue;
        if (both.meshes.size() > kMostMeshes) return std::nullopt;
        shared.push_back(both);
    }
    std::vector<Signed> taken;
    for (const Region& both : shared) {
        const std::optional<TriMesh>& surface = surface_of(both.meshes);
        if (!surface) return std::nullopt;
        taken.push_back({clipped_to_box(*surface, both.box), both.sign});
    }
    return taken;
}

InsetRegions::Region InsetRegions::all_of(int inset) const {
    if (box_[inset]) return {{}, *box_[inset]};
    return {{inset}, everywhere()};
}

InsetRegions::Region InsetRegions::common(const Region& region, int inset) const {
    Region both = region;
    both.box = common_box(region.box, bounds_[inset]);
    if (!box_[inset]) both.meshes.push_back(inset);
    return both;
}

void InsetRegions::give_way(int inset, std::vector<Region>& regions) const {
    if (regions.size() > kMostRegions) return;
    std::vector<Region> left;
    for (const Region& region : regions) {
        const Region both = common(region, inset);
        if (holds_nothing(both.box)) {
            left.push_back(region);
        } else if (!box_[inset]) {
            left.push_back(region);
            left.push_back(both);
            left.back().sign *= -1;
        } else {
            Region rest = region;
            for (int axis = 0; axis < 3; ++axis) {
                Region below = rest, above = rest;
                below.box.high[axis] = rest.box.low[axis] = both.box.low[axis];
                above.box.low[axis] = rest.box.high[axis] = both.box.high[axis];
                for (const Region& part : {below, above}) {
                    if (!holds_nothing(part.box)) left.push_back(part);
                }
            }
        }
    }
    regions = std::move(left);
}

const std::optional<TriMesh>& InsetRegions::surface_of(const std::vector<int>& meshes) {
    const auto known = surface_.find(meshes);
    if (known != surface_.end()) return known->second;
    const std::vector<int> fewer(meshes.begin(), meshes.end() - 1);
    const std::optional<TriMesh>& rest = surface_of(fewer);
    std::optional<TriMesh> both(std::in_place);
    const TriMesh& last = insets_[meshes.back()].solid;
    const bool is_known = rest && (rest->triangle.empty() || intersect(*rest, last, *both));
    if (!is_known) both.reset();
    return surface_[meshes] = std::move(both);
}

}  // namespace swage
