// SPDX-License-Identifier: GPL-3.0-or-later
// Keys that a scene gives and that can do nothing in it.
#pragma once

#include "scene/document.h"
#include "scene/spec.h"

namespace swage {

// Of a scene without mistakes; each at its place. `root`: the file of the scene.
void warn_of_idle_keys(const Node& root, const SceneSpec& scene, MistakeList& mistakes);

}  // namespace swage
