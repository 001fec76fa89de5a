// SPDX-License-Identifier: GPL-3.0-or-later
// What a run keeps of itself once a stage is finished, to go on from: where it ends early, or where
// later stages are changed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/frame_store.h"
#include "pipeline/json.h"
#include "pipeline/run_identity.h"
#include "pipeline/work_piece.h"

namespace swage {

// All that stages hand on, beside the files that they leave.
struct Reached {
    int stages = 0;  // finished
    std::vector<WorkPiece> bodies;
    std::string contacts;                                // as Simulation hands them on
    Json matter = Json::array(), stage = Json::array();  // of each body and stage, for run.json
    std::vector<std::string> start_warning, warning;     // of what was molded, and of stages
    long steps = 0;
    std::vector<std::pair<std::string, double>> seconds;  // by phase
    MotionMark motion;
    std::vector<int> skin;  // of each body: its number in the motion file
    std::string foreseen;   // key of the whole run whose stages `start_warning` foresees
};

// Under its name when it is whole. Throws Error(output).
void write_checkpoint(const std::filesystem::path& file, const StageKeys& keys,
                      const Reached& reached);

// Nothing where there is none that can be gone on from by these keys, and then `why`, as in "is
// damaged"; empty: no file.
std::optional<Reached> read_checkpoint(const std::filesystem::path& file, const StageKeys& keys,
                                       std::string& why);

// Whether it says to be of so many stages, by these keys.
bool is_kept(const std::filesystem::path& file, const StageKeys& keys, int stages);

}  // namespace swage
