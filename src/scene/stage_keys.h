// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace swage {

// Whether every [[stage]] has the key, whatever its machine; no parameter may have its name.
bool is_stage_key(const std::string& key);

}  // namespace swage
