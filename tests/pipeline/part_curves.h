// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pipeline/curves.h"

namespace swage::test {

// Of a stage whose loads are all of the machine, none about a known axis; without probes.
inline StageCurves part_curves(const std::string& stage, int first_frame,
                               const std::vector<ToolLoad>& start, const FrameReport& bodies = {}) {
    return {stage, first_frame, start, bodies, start.size(), {}, {}};
}

}  // namespace swage::test
