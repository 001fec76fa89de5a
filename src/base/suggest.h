// SPDX-License-Identifier: GPL-3.0-or-later
// What a mistyped word was meant to be.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace swage {

// Fewest single letters put in, taken out or changed, or neighbours swapped (optimal string
// alignment); upper and lower case count as the same.
int edit_distance(std::string_view a, std::string_view b);

// The known word nearest to this one, or empty when none is near. A known word also counts as near
// when one of its parts does ("yeild" finds "yield_stress"). The first of equals wins.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

// `, did you mean "yield_stress"?`, or empty.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

// A hint and what else is to be said: `, did you mean "mm"? Expected a length`; where there is no
// hint, `; expected a length`.
std::string hint_and(const std::string& hint, std::string more);

}  // namespace swage
