// SPDX-License-Identifier: GPL-3.0-or-later
// What is odd about where a stage got to, in sentences for its user.
#pragma once

#include <string>
#include <vector>

#include "pipeline/stage_record.h"

namespace swage {

struct StageVerdict {
    std::vector<std::string> warning;
    double overlap = 0;  // the deepest of a body with itself, where that is looked for [m]
};

// How deep each of several bodies in motion lies in another [m].
std::vector<double> overlaps_of(std::vector<WorkPiece>& bodies, const SimSettings& sim);

// `pieces_before`: of all bodies. A stage that ended early is not blamed for what it had not come
// to; one that was interrupted not even looked at closely.
enum class StageEnded { wholly, stopped, interrupted };
StageVerdict judge_stage(const StageEnd& end, int pieces_before, StageEnded ended);

}  // namespace swage
