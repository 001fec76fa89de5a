// SPDX-License-Identifier: GPL-3.0-or-later
// What is to be said of many bodies in the same words is said once, with the bodies that it is
// about.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace swage {

// "all 200 bodies", "ball", "ball and gear", "ball, body-3 to body-9". `of`: in order.
std::string bodies_text(const std::vector<std::string>& name, const std::vector<std::size_t>& of);

struct FoldedText {
    std::string text;
    std::vector<std::size_t> body;  // whose it is, in order
};

// `texts`: of each body. In the order in which they come first.
std::vector<FoldedText> folded(const std::vector<std::vector<std::string>>& texts);

// Of each body what was found as it was molded: "mold of body-2 to body-9: ...", of a single one
// "mold: ...".
std::vector<std::string> folded_warnings(const std::vector<std::string>& name,
                                         const std::vector<std::vector<std::string>>& findings);

}  // namespace swage
