// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "render/settings.h"
#include "scene/spec.h"
#include "scene/table_reader.h"

namespace swage {

// [render] and its sections; what it hides are parts of the stages' machines.
void read_render(TableReader& table, const std::vector<StageSpec>& stages,
                 RenderSettings& settings);

}  // namespace swage
