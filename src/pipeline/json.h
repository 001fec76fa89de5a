// SPDX-License-Identifier: GPL-3.0-or-later
// JSON values whose keys keep the order in which they were set.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace swage {

using Json = nlohmann::ordered_json;

// One document, indented, ending in a newline. Text that is no UTF-8 (a file name may be any
// bytes) is shown with replacement characters and never throws.
inline std::string json_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace swage
