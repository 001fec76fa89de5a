// SPDX-License-Identifier: GPL-3.0-or-later
// The way that blades take through matter which itself moves.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"

namespace swage {

// The blades' way as a body meets it that flies on as it does now (way[0]) and falls: each blade is
// farther on its own way by as much as the body has come against it along that. A blade cuts by its
// own motion, so what comes along with it or across it adds nothing, and nothing adds to one that
// rests. That of a body that stays at rest is as given. `gravity`: at full strength [m/s2].
std::vector<Drive> way_in_flight(const Aggregate& matter, const Apparatus& apparatus,
                                 std::span<const Drive> way, const Vec3& gravity);

// The way on which the others than the marked blades stand still, and so sweep nothing.
std::vector<Drive> way_of(const std::vector<char>& blades, std::span<const Drive> way);

// How far the middle of its edge goes.
Vec3 way_between(const Blade& blade, const Pose& from, const Pose& to);

bool is_gripped(const Apparatus& apparatus, std::size_t body);

// How many unsevered connections have gone past an edge, or it past them, on this way since their
// particles were at `before`. Of the marked blades, or of all.
std::size_t count_passed(const Aggregate& matter, const Vec3Array& before,
                         const Apparatus& apparatus, const Drive& from, const Drive& to,
                         const std::vector<char>& blades = {});

}  // namespace swage
