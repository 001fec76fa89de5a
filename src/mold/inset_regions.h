// SPDX-License-Identifier: GPL-3.0-or-later
// What of a body each of its insets has, as surfaces: of insets that overlap, the last has it.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "geometry/box.h"
#include "mold/mold.h"

namespace swage {

// Of boxes these are exact; of meshes, where these can be intersected (geometry/mesh_unite.h).
// Insets are added in their order, and asked for before the next is.
class InsetRegions {
  public:
    InsetRegions(const TriMesh& body, const std::vector<Inset>& insets);

    // `inside`: its surface is known to share no cells with the body's, and bounds what of it lies
    // in the body there.
    void add(int inset, bool inside);
    // What of the inset added last lies in the body; none when it cannot be made.
    std::optional<TriMesh> in_body();
    // What it takes of an older one; none when that cannot be made.
    struct Signed {
        TriMesh mesh;
        double sign;
    };
    std::optional<std::vector<Signed>> taken_from(int older);

  private:
    // What the body and these meshes have in common, by number, in the box; more of it or less.
    struct Region {
        std::vector<int> meshes;
        Box box;
        double sign = 1;
    };
    Region all_of(int inset) const;
    Region common(const Region& region, int inset) const;
    void give_way(int inset, std::vector<Region>& regions) const;
    const std::optional<TriMesh>& surface_of(const std::vector<int>& meshes);

    const std::vector<Inset>& insets_;
    std::vector<std::optional<Box>> box_;  // of those that are boxes
    std::vector<Box> bounds_;
    std::vector<std::vector<Region>> had_, has_;  // before the inset added last and after it
    std::map<std::vector<int>, std::optional<TriMesh>> surface_;
};

}  // namespace swage
