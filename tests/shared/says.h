// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace swage::test {

inline bool says(const std::string& text, const std::string& words) {
    return text.find(words) != std::string::npos;
}

}  // namespace swage::test
