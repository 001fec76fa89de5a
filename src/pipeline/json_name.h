// SPDX-License-Identifier: GPL-3.0-or-later
// The name of pipeline/json.h's values, for headers that only pass them on: what they are made of
// takes longer to compile than all else of most sources.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace swage {

using Json = nlohmann::ordered_json;

}  // namespace swage
