// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces of a body's insets, which go with its matter as its skin does: where a later stage
// molds it anew, it has its insets from them.
#pragma once

#include <array>
#include <vector>

#include "matter/aggregate.h"
#include "mold/mold.h"
#include "scene/spec.h"
#include "skin/mount.h"

namespace swage {

struct CarriedInset {
    TriMesh mesh;  // closed; its positions: as mounted
    Mount mount;
    std::vector<Vec3> position;  // now [m]
    // A blade's path bends or turns within it: it is not cut along that.
    bool is_torn = false;
};

// Whether any stage from this one on, counted from 0, molds anew a work-piece that has insets.
bool carries_insets(const SceneSpec& scene, std::size_t from_stage);

// As the matter stands at molding. Where an inset lies on the surface of `body` it is made to reach
// a little out of it, as the two bend each by its own triangles; what reaches out farther than a
// cell is cut off. Null: they were carried before, and reach out already.
std::vector<CarriedInset> carry_insets(const std::vector<Inset>& insets, const TriMesh* body,
                                       const Aggregate& matter);

// As follow_matter(), hold_skin() and cut_skins() do with skins (pipeline/work_piece.h).
void follow_insets(std::vector<CarriedInset>& insets, const Aggregate& matter);
void hold_insets(std::vector<CarriedInset>& insets, const Aggregate& matter);
void cut_insets(std::vector<CarriedInset>& insets, const Aggregate& matter,
                const std::vector<std::array<Vec3, 3>>& sweep);

// Where they are now, parted as the matter is, of its materials. Throws Error(stopped) where one
// is torn.
std::vector<Inset> insets_now(const std::vector<CarriedInset>& insets, const Aggregate& matter);

}  // namespace swage
