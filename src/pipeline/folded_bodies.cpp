// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/folded_bodies.h"

#include <algorithm>

#include "base/text.h"

namespace swage {

namespace {

constexpr std::size_t kRange = 3;  // names in a row that "to" stands for

}  // namespace

std::string bodies_text(const std::vector<std::string>& name, const std::vector<std::size_t>& of) {
    if (of.size() == name.size() && of.size() >= kRange) {
        return fmt::format("all {} bodies", of.size());
    }
    std::vector<std::string> parts;
    for (std::size_t first = 0, last; first < of.size(); first = last + 1) {
        last = first;
        while (last + 1 < of.size() && of[last + 1] == of[last] + 1) ++last;
        if (last - first + 1 < kRange) last = first;
        parts.push_back(name[of[first]] + (last > first ? " to " + name[of[last]] : ""));
    }
    return parts.size() == 2 ? joined(parts, " and ") : joined(parts, ", ");
}

std::vector<FoldedText> folded(const std::vector<std::vector<std::string>>& texts) {
    std::vector<FoldedText> folded;
    for (std::size_t b = 0; b < texts.size(); ++b) {
        for (const std::string& text : texts[b]) {
            const auto known =
                std::find_if(folded.begin(), folded.end(),
                             [&](const FoldedText& other) { return other.text == text; });
            if (known == folded.end()) {
                folded.push_back({text, {b}});
            } else if (known->body.back() != b) {
                known->body.push_back(b);
            }
        }
    }
    return folded;
}

std::vector<std::string> folded_warnings(const std::vector<std::string>& name,
                                         const std::vector<std::vector<std::string>>& findings) {
    std::vector<std::string> told;
    for (const FoldedText& one : folded(findings)) {
        told.push_back(name.size() > 1
                           ? fmt::format("mold of {}: {}", bodies_text(name, one.body), one.text)
                           : "mold: " + one.text);
    }
    return told;
}

}  // namespace swage
