// SPDX-License-Identifier: GPL-3.0-or-later
// What the first stage cannot come to, by how the work-piece lies before it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/named_matter.h"
#include "scene/spec.h"

namespace swage {

// Of a single body that nothing takes hold of: whether it reaches the floor in the time that the
// stage has, and whether loads lift it off what it lies on. Only what is certain is told.
std::vector<std::string> doubts_of_start(const SceneSpec& scene,
                                         const std::vector<NamedMatter>& bodies);

}  // namespace swage
