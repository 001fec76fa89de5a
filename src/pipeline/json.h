// SPDX-License-Identifier: GPL-3.0-or-later
// JSON values whose keys keep the order in which they were set.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/json_name.h"

namespace swage {

// Of what reads and writes it each place that does would compile its own, a second's worth.
Json parse_json(const std::string& text);  // throws Json::exception

// One document, indented, ending in a newline. Text that is no UTF-8 (a file name may be any
// bytes) is shown with replacement characters and never throws.
std::string json_text(const Json& json);

}  // namespace swage
