// SPDX-License-Identifier: GPL-3.0-or-later
// Kinds of characters, whatever the locale.
#pragma once

namespace swage {

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// Of names in plain letters, as of parts of machines.
constexpr bool begins_name(char c) { return is_letter(c) || c == '_'; }
constexpr bool goes_on_name(char c) { return begins_name(c) || is_digit(c); }

// Of words that people write, which may hold any letter of UTF-8.
constexpr bool begins_word(char c) {
    return begins_name(c) || static_cast<unsigned char>(c) >= 0x80;
}
constexpr bool goes_on_word(char c) { return begins_word(c) || is_digit(c); }

}  // namespace swage
