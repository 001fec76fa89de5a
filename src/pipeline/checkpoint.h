// SPDX-License-Identifier: GPL-3.0-or-later
// What a run keeps of itself once a stage is finished, to go on from if it ends early.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/frame_store.h"
#include "pipeline/json.h"
#include "pipeline/work_piece.h"

namespace swage {

// All that stages hand on, beside the files that they leave.
struct Reached {
    int stages = 0;  // finished
    std::vector<WorkPiece> bodies;
    Json matter = Json::array(), stage = Json::array();  // of each body and stage, for run.json
    std::vector<std::string> warning;
    long steps = 0;
    std::vector<std::pair<std::string, double>> seconds;  // by phase
    MotionMark motion;
    std::vector<int> skin;  // of each body: its number in the motion file
};

// Under its name when it is whole. `key`: of the run, and of the build that reads it again. Throws
// Error(output).
void write_checkpoint(const std::filesystem::path& file, const std::string& key,
                      const Reached& reached);

// Nothing where there is none that can be gone on from by this key, and then `why`, as in "is
// damaged"; empty: no file.
std::optional<Reached> read_checkpoint(const std::filesystem::path& file, const std::string& key,
                                       std::string& why);

}  // namespace swage
