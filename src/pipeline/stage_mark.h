// SPDX-License-Identifier: GPL-3.0-or-later
// What a run keeps of a stage at the end of one of its frames, to go on from within it. It goes
// with how the stage began, which is in the checkpoint of the stage before or is molded anew: what
// is derived from that is not kept.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/checkpoint.h"

namespace swage {

struct StageMark {
    int stages = 0;  // finished before it
    int frame = 0;   // of the run, the last that is finished
    MotionMark motion;
    std::vector<int> skin;                                // as of Reached
    std::vector<std::pair<std::string, double>> seconds;  // by phase
    std::string state;                                    // of the stage's run and its simulation
    std::vector<WorkPiece> bodies;
};

// `bodies` stand for those of the mark, which are left out. Returns how long the file is [byte].
// Throws Error(output).
std::size_t write_stage_mark(const std::filesystem::path& file, const StageKeys& keys,
                             const StageMark& mark, const std::vector<WorkPiece>& bodies);

// Of the run by these keys that has finished so many stages; else as read_checkpoint().
std::optional<StageMark> read_stage_mark(const std::filesystem::path& file, const StageKeys& keys,
                                         int stages, std::string& why);

}  // namespace swage
