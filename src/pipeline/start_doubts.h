// SPDX-License-Identifier: GPL-3.0-or-later
// What stages cannot come to, by how the bodies lie before them.
#pragma once

#include <string>
#include <vector>

#include "pipeline/named_matter.h"
#include "scene/spec.h"

namespace swage {

// Of what nothing takes hold of: whether it reaches the floor in the time that the first stage has,
// and whether loads or gravity take it off what it lies on, in that and in later ones. Only what is
// certain is told.
std::vector<std::string> doubts_of_start(const SceneSpec& scene,
                                         const std::vector<NamedMatter>& bodies);

}  // namespace swage
