// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts of one body that are yet to be made, of blades that come to it at different times. What
// several of them are to sever stands in the plan for each: the first that comes by does.
#pragma once

#include <deque>
#include <vector>

#include "matter/point_side.h"
#include "sim/sever.h"

namespace swage {

using CutPlan = std::deque<std::vector<SeverEvent>>;  // by leg, from the coming one on

// Takes what the marked blades are to sever out of the plan, which keeps its length; none marked:
// of all.
CutPlan take_out(CutPlan& plan, const std::vector<char>& blades);
// Of as many legs; the other's events come behind its own.
void add_plan(CutPlan& plan, const CutPlan& more);
bool severs_any(const CutPlan& plan);
// Anything that the other does not.
bool severs_more(const CutPlan& plan, const CutPlan& than);

// Of those of one connection the first stays.
void drop_doubles(std::vector<SeverEvent>& events);

// Of a point that both tell of only the corners on its side by both are.
void add_sides(std::vector<PointSide>& sides, const std::vector<PointSide>& more);

}  // namespace swage
