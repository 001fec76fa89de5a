// SPDX-License-Identifier: GPL-3.0-or-later
// Small work on text; other text is made by fmt.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

namespace swage {

std::string joined(const std::vector<std::string>& items, const char* separator);
std::vector<std::string> lines_of(const std::string& text);

// "1 hole", "3 holes".
std::string counted(std::size_t count, const char* one, const char* many);

// For terminals and for sentences that are C strings: control characters but tabs and ends of lines
// as "\x1b".
std::string printable(std::string_view text);

// 1234567 as "1,234,567"; 12345678 bytes as "11.8 MiB"; 75 s as "1 min 15 s".
std::string count_text(double count);
std::string bytes_text(double bytes);
std::string seconds_text(double seconds);

}  // namespace swage
