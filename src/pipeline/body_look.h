// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "scene/spec.h"

namespace swage {

// How all of a body looks: by the scene's colour or texture, or else by its material, where the
// mesh says nothing or the scene asks for it. None: as the mesh says.
std::optional<SurfaceMaterial> body_look(const BodySpec& body, const TriMesh& mesh);

// Gives all its materials the scene's colour of what lies under them, if it has one.
void color_inside(const BodySpec& body, TriMesh& mesh);

// How cut faces look that show its insets, of a skin that is `dressed`: one each.
std::vector<SurfaceMaterial> inset_looks(const BodySpec& body, const TriMesh& dressed);

// Whether the mesh says how it looks, and the scene does not, so that its material's look is not
// seen.
bool hides_material(const BodySpec& body, const TriMesh& mesh);

}  // namespace swage
