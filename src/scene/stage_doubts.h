// SPDX-License-Identifier: GPL-3.0-or-later
// Stages that say what nobody can be supposed to mean.
#pragma once

#include "scene/document.h"
#include "scene/spec.h"

namespace swage {

// Of a scene without mistakes, at their places: machines and loads that are asked for nothing, and
// stages in which down is elsewhere than in those before. `root`: the file of the scene.
void warn_of_doubtful_stages(const Node& root, const SceneSpec& scene, MistakeList& mistakes);

}  // namespace swage
