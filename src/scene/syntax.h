// SPDX-License-Identifier: GPL-3.0-or-later
// Broken TOML syntax, told in the user's terms, and how reading can go on after it.
#pragma once

#include <string>
#include <string_view>

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

// The line without its end, from 1; empty beyond the last.
std::string_view line_of(std::string_view file_text, int line);

}  // namespace swage
