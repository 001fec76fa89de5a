// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pipeline/counted_matter.h"
#include "scene/spec.h"

namespace swage {

// Which of several bodies makes explicit steps far shorter than others need; empty: none does.
std::string step_note(const SceneSpec& scene, const CountedMatter& counted);

}  // namespace swage
