// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces of a body's insets, which go with its matter as its skin does: where a blade cuts
// it, its cut faces show them, and where a later stage molds it anew, it has its insets from them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "matter/aggregate.h"
#include "mold/mold.h"
#include "scene/spec.h"
#include "skin/insides.h"
#include "skin/mount.h"

namespace swage {

struct CarriedInset {
    TriMesh mesh;  // closed; its positions: as mounted
    Mount mount;
    std::vector<Vec3> position;  // now [m]
    // A blade's path turns back over itself within it: it is not cut along that.
    bool is_torn = false;
    SurfaceMaterial look = {};  // of cut faces that show it
};

// Whether the work-piece has insets that any stage from this one on, counted from 0, cuts or molds
// anew. `is_molded`: this one has been molded anew already.
bool carries_insets(const SceneSpec& scene, std::size_t from_stage, bool is_molded = false);

// As the matter stands at molding. Where an inset lies on the surface of `body` it is made to reach
// a little out of it, as the two bend each by its own triangles; what reaches out farther than a
// cell is cut off. Null: they were carried before, and reach out already. `looks`: one each.
std::vector<CarriedInset> carry_insets(const std::vector<Inset>& insets,
                                       std::vector<SurfaceMaterial> looks, const TriMesh* body,
                                       const Aggregate& matter);

// As follow_matter(), hold_skin() and cut_skins() do with skins (pipeline/work_piece.h).
void follow_insets(std::vector<CarriedInset>& insets, const Aggregate& matter);
void hold_insets(std::vector<CarriedInset>& insets, const Aggregate& matter);
void cut_insets(std::vector<CarriedInset>& insets, const Aggregate& matter,
                const std::vector<std::array<Vec3, 3>>& sweep);

// What a blade lays open that goes through them now.
Insides insides_now(const std::vector<CarriedInset>& insets);

// Where they are now, parted as the matter is, of its materials. What had to be closed is told in
// `findings`. Throws Error(stopped) where one is torn.
std::vector<Inset> insets_now(const std::vector<CarriedInset>& insets, const Aggregate& matter,
                              std::vector<std::string>& findings);

}  // namespace swage
