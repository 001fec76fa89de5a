// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/move_warnings.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"

namespace swage {

namespace {

std::string all_of(const std::vector<std::string>& name) {
    std::string names;
    for (std::size_t n = 0; n < name.size(); ++n) {
        if (n > 0) names += n + 1 == name.size() ? " and " : ", ";
        names += name[n];
    }
    return names;
}

}  // namespace

std::vector<std::string> move_warnings(const MoveOutcome& outcome) {
    std::vector<std::string> warning;
    if (!outcome.lost.empty()) {
        warning.emplace_back(fmt::format(
            "the work-piece slipped away from {}, or contracted, although no tool drew back",
            all_of(outcome.lost)));
    }
    if (!outcome.pierced.empty()) {
        warning.emplace_back(fmt::format(
            "parts of the work-piece's surface have gone through {} at once, by more "
            "than a cell, and {} them no longer: raise frames or contact_stiffness, or "
            "make {} thicker",
            all_of(outcome.pierced), outcome.pierced.size() == 1 ? "it holds" : "these hold",
            outcome.pierced.size() == 1 ? "it" : "them"));
    }
    if (outcome.afloat > 0) {
        const bool one = outcome.afloat == 1;
        warning.emplace_back(fmt::format(
            "{} would fall, as nothing holds {} against gravity and loads: equilibria cannot fall "
            "(solver = \"explicit\" can), so from here on they leave {} alone",
            one ? "a piece" : fmt::format("{} pieces", outcome.afloat), one ? "it" : "them",
            one ? "it" : "them"));
    }
    if (outcome.hanging > 0) {
        const bool one = outcome.hanging == 1;
        warning.emplace_back(
            fmt::format("{} by less than a whole cell, which cannot hold {} against gravity and "
                        "loads: from here on equilibria leave {} alone",
                        one ? "a piece hangs" : fmt::format("{} pieces hang", outcome.hanging),
                        one ? "it" : "them", one ? "it" : "them"));
    }
    if (outcome.let_be > 0) {
        warning.emplace_back(
            fmt::format("found no equilibrium with {} of the work-piece's surface more than a "
                        "fifth of a cell deep in itself: from here on these pass through it",
                        counted(static_cast<std::size_t>(outcome.let_be), "point", "points")));
    }
    if (outcome.left_over > 0) {
        warning.emplace_back(
            fmt::format("what was out of balance when the stage began, or was cut, broken or "
                        "released since, does not come to rest as exactly as the loads require: "
                        "from here on {:.2g} N may be out of balance",
                        outcome.left_over));
    }
    if (outcome.rounded > 0) {
        warning.emplace_back(
            fmt::format("loads are so small for matter this stiff and this far from the origin "
                        "that its places, to sixteen digits, leave up to {:.1g} N out of balance",
                        outcome.rounded));
    }
    if (std::any_of(outcome.body.begin(), outcome.body.end(),
                    [](const BodyOutcome& body) { return body.drag_bounded; })) {
        warning.emplace_back(
            "the drag is so strong that it stops parts of the surface within a few steps; there it "
            "is limited to what a step can follow");
    }
    if (outcome.rescued > 0) {
        warning.emplace_back(fmt::format(
            "explicit steps failed however short they were: {} implicit ones replace them",
            outcome.rescued));
    }
    if (outcome.inside_out > 0) {
        warning.emplace_back(
            fmt::format("{} turned inside out, which shorter steps did not prevent: the matter is "
                        "crushed harder than its stiffness can hold",
                        counted(static_cast<std::size_t>(outcome.inside_out), "cell", "cells")));
    }
    if (outcome.buckled) {
        warning.emplace_back("the work-piece buckled: it changed to another shape");
    }
    return warning;
}

}  // namespace swage
