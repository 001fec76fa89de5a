// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/document.h"

namespace swage {

// By key: those of one key stay in their order, in which later ones win, and the order of others
// makes no difference.
std::vector<std::string> in_order(std::vector<std::string> overrides);

// Puts "stage.1.angle=45 deg" and the like into the tree as if the file said so; their values and
// keys stand at "--set ...". A stage goes by number, name, machine or *. Later ones win.
void apply_overrides(const std::vector<std::string>& overrides, Node& root, MistakeList& mistakes);

}  // namespace swage
