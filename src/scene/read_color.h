// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "scene/table_reader.h"

namespace swage {

// `color = [red, green, blue]`, each 0 to 1 as on a screen, if the table has it: linear RGB.
void read_color(TableReader& table, std::optional<Vec3>& color, const std::string& key = "color");

}  // namespace swage
