// SPDX-License-Identifier: GPL-3.0-or-later
// Loads: [[load]] of a machine file, [[stage.load]] of a scene.
//
//     name      letters, digits and _; a scene's may go without
//     force     three forces in the work frame, in all; or
//     pressure  along the inward normal of the surface as it deforms
//     on        "all", or the side that the surface looks to: "left", "right" (along the length),
//               "bottom", "top", "back", "front"; "inside": the walls of closed cavities
//     from, to  corners of a box in the work frame that it lies in
//     strength  times the load, over t from 0 to 1; by default it grows until the stage ends
#pragma once

#include <set>
#include <string>

#include "scene/expressions.h"
#include "scene/table_reader.h"

namespace swage {

// Whether a text can name a part or a parameter of a machine.
bool is_part_name(const std::string& text);

// The name of a part of a machine, needed, new and then among `names`.
std::string read_part_name(TableReader& table, std::set<std::string>& names);

// What a load of a scene is called that nobody names; the stage's first is number 1.
std::string usual_load_name(std::size_t number);

// All keys but the name. `expression` sees all but t.
void read_load_keys(TableReader& table, ExpressionReader& expression, LoadSpec& load);

}  // namespace swage
