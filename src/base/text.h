// SPDX-License-Identifier: GPL-3.0-or-later
// Small work on text. (fmt::join over strings makes GCC 12 warn of what is not there.)
#pragma once

#include <string>
#include <vector>

namespace swage {

inline std::string joined(const std::vector<std::string>& items, const char* separator) {
    std::string text;
    for (const std::string& item : items) {
        if (&item != &items.front()) text += separator;
        text += item;
    }
    return text;
}

}  // namespace swage
