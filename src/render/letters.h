// SPDX-License-Identifier: GPL-3.0-or-later
// Letters of any size, of outlines that are built in: the same bytes everywhere, and no font that
// would have to be there.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace swage {

inline constexpr double kLetterHeight = 0.73;  // of a capital or a digit, of the size

// A letter's pixels, rows from the top: how much of each it covers, 255 all.
struct LetterPixels {
    int left, top, width, height;
    std::vector<std::uint8_t> cover;
};
// One line that begins at x and stands on y; what is no printable ASCII is written "?". `size`: of
// what holds a letter with all that goes above and below it [pixel], more than 0.
std::vector<LetterPixels> letters_of(const std::string& text, double x, double y, double size);
double letters_width(const std::string& text, double size);

std::span<const unsigned char> embedded_font();  // assets/fonts/DejaVuSans-ASCII.ttf

}  // namespace swage
