// SPDX-License-Identifier: GPL-3.0-or-later
// JSON as tests read it. Before anything else that Catch2 may have to show a value of.
#pragma once

#include "pipeline/json.h"
#include "tests/catch.h"

template <>
struct Catch::StringMaker<swage::Json> {
    static std::string convert(const swage::Json& json) { return swage::json_text(json); }
};

using swage::Json;
using swage::json_text;
using swage::parse_json;
