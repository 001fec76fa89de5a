// SPDX-License-Identifier: GPL-3.0-or-later
// Letters built of whole pixels, those of stb_easy_font: the same bytes everywhere, and no font
// that would have to be there.
#pragma once

#include <string>
#include <vector>

namespace swage {

inline constexpr int kLetterLine = 12;  // rows of a line

// Part of a letter, from the left and the top of the line, its ends left out.
struct LetterPart {
    int left, top, right, bottom;
};
// Of one line; what is no printable ASCII is written "?".
std::vector<LetterPart> letters_of(const std::string& text);
int letters_width(const std::string& text);

}  // namespace swage
