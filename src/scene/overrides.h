// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/document.h"

namespace swage {

// Puts "stage.1.angle=45 deg" and the like into the tree as if the file said so; their values and
// keys stand at "--set ...". A stage goes by number, name, machine or *. Later ones win.
void apply_overrides(const std::vector<std::string>& overrides, Node& root, MistakeList& mistakes);

}  // namespace swage
