// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <string>

#include "base/units.h"

namespace swage {

// quantity_text() of what was measured or is a sum of many parts, to so many digits.
inline std::string rounded_text(double value, Quantity quantity, int digits) {
    return quantity_text(std::stod(fmt::format("{:.{}g}", value, digits)), quantity);
}

}  // namespace swage
