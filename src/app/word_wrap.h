// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sstream>
#include <string>

namespace swage {

constexpr std::size_t kTextWidth = 100;  // of a terminal; longer words stand out

// Its words in lines of that width. The first begins in column `at`, where the caller is; the
// others are indented by `indent`. No end of line behind the last.
inline std::string wrapped(const std::string& text, std::size_t at, std::size_t indent) {
    std::string out, word;
    std::size_t column = at;
    bool begins = true;
    for (std::istringstream in(text); in >> word;) {
        if (!begins && column + 1 + word.size() > kTextWidth) {
            out += "\n" + std::string(indent, ' ');
            column = indent;
            begins = true;
        }
        if (!begins) out += ' ', ++column;
        out += word;
        column += word.size();
        begins = false;
    }
    return out;
}

}  // namespace swage
