// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "render/settings.h"
#include "scene/table_reader.h"

namespace swage {

// [render] and [render.camera].
void read_render(TableReader& table, RenderSettings& settings);

}  // namespace swage
