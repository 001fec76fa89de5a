// SPDX-License-Identifier: GPL-3.0-or-later
// What a run keeps of a stage at the end of one of its frames, to go on from within it. It goes
// with how the stage began, which is in the checkpoint of the stage before or is molded anew: what
// is derived from that is not kept.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "pipeline/frame_store.h"
#include "pipeline/run_identity.h"
#include "pipeline/work_piece.h"

namespace swage {

struct StageMark {
    int stages = 0;  // finished before it
    int frame = 0;   // of the run, the last that is finished
    MotionMark motion;
    std::vector<int> skin;                                // as of Reached
    std::vector<std::pair<std::string, double>> seconds;  // by phase
    std::vector<WorkPiece> bodies;
    std::string bytes;      // of the file, of which
    std::size_t state = 0;  // from here on are what the stage's run and its simulation are at
};

// `bodies` stand for those of the mark, `state` for its bytes, and both are written as they are
// said. Returns how long the file is [byte]. Throws Error(output).
std::size_t write_stage_mark(const std::filesystem::path& file, const StageKeys& keys,
                             const StageMark& mark, const std::vector<WorkPiece>& bodies,
                             const std::function<void(ByteWriter&)>& state);

// Of the run by these keys that has finished so many stages; else as read_checkpoint().
std::optional<StageMark> read_stage_mark(const std::filesystem::path& file, const StageKeys& keys,
                                         int stages, std::string& why);

}  // namespace swage
