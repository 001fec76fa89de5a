// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "skin/boundary.h"

namespace swage::test {

// A boundary where its matter is now.
inline TriMesh boundary_now(const Aggregate& matter, const NewLook* look = nullptr) {
    BoundarySkin skin = boundary_skin(matter, look);
    skin_positions(skin.mount, matter, skin.mesh.position);
    return std::move(skin.mesh);
}

}  // namespace swage::test
