// SPDX-License-Identifier: GPL-3.0-or-later
// Small work on text. (fmt::join over strings makes GCC 12 warn of what is not there.)
#pragma once

#include <fmt/format.h>

#include <sstream>
#include <string>
#include <string_view>
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

inline std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

// "1 hole", "3 holes".
inline std::string counted(std::size_t count, const char* one, const char* many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
}

// For terminals and for sentences that are C strings: control characters but tabs and ends of lines
// as "\x1b".
std::string printable(std::string_view text);

// 1234567 as "1,234,567"; 12345678 bytes as "11.8 MiB"; 75 s as "1 min 15 s".
std::string count_text(double count);
std::string bytes_text(double bytes);
std::string seconds_text(double seconds);

}  // namespace swage
