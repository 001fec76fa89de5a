// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene says of fields of the matter on the skin, and of what is drawn beside stills.
#pragma once

#include <vector>

#include "matter/skin_field.h"
#include "render/settings.h"
#include "scene/table_reader.h"

namespace swage {

void read_fields(TableReader& output, std::vector<SkinField>& fields);
void read_passes(TableReader& render, std::vector<PicturePass>& passes);
void read_field_color(TableReader& render, RenderSettings& settings);

// What is to be drawn is asked for with the others.
void add_drawn_field(const RenderSettings& settings, std::vector<SkinField>& fields);

}  // namespace swage
