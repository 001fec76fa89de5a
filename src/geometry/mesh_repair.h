// SPDX-License-Identifier: GPL-3.0-or-later
// From a surface as files have them to one that bounds a volume.
#pragma once

#include <string>
#include <vector>

#include "geometry/crease_angle.h"
#include "geometry/trimesh.h"

namespace swage {

struct Repair {
    TriMesh mesh;                      // closed, oriented, of positive volume
    std::vector<std::string> account;  // a sentence for everything that was done; empty: nothing
};

// As far as needed: duplicates go, gaps between vertices are stitched, triangles are turned to
// agree, holes are filled, small open sheets are left out, inside-out bodies are turned, a body
// within a body of the same sense is left out (its volume would count twice), bodies that cross are
// united. What that cannot mend is wrapped anew, without its attributes. Attributes stay with every
// triangle that stays. Throws Error(mesh) when no volume can be made of it, such as for an open
// sheet.
// Of a mesh that already bounds a volume only surfaces given more than once and the bodies are put
// right; if they are, or cannot be, it comes back as it is, cavities included (closed surfaces
// inside another that face inwards).
// `crease_angle`: beyond which edges of what is made anew are sharp, as they are where they are
// read [rad].
Repair repair_mesh(const TriMesh& mesh, double crease_angle = kCreaseAngle);

}  // namespace swage
