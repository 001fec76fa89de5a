// SPDX-License-Identifier: GPL-3.0-or-later
// Broken TOML syntax, told in the user's terms, and how reading can go on after it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace swage {

struct SyntaxMistake {
    int line, column;  // where the TOML reader gave up
    std::string description;
};

struct SyntaxAdvice {
    int column;
    std::string text;
    bool can_go_on;  // the line stands alone: reading can go on without it
};

SyntaxAdvice explain_syntax(std::string_view file_text, const SyntaxMistake& mistake);

// Line and column of the first key of more dotted parts (a.b.c) than anybody means: each is a table
// in a table, and who follows them down needs a stack as deep.
inline constexpr int kMostKeyParts = 16;
std::optional<std::pair<int, int>> too_deep_key(std::string_view file_text);

// The line without its end, from 1; empty beyond the last.
std::string_view line_of(std::string_view file_text, int line);

}  // namespace swage
