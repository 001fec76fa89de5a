// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/json.h"

namespace swage {

Json parse_json(const std::string& text) { return Json::parse(text); }

std::string json_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace swage
