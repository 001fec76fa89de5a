// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/kept_run.h"

#include <utility>

#include "base/error.h"
#include "base/log.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr const char* kMotionDamaged = "goes with a motion file that is damaged";

// The file that holds it, if any does.
std::optional<fs::path> motion_of(const RunDirectory& directory, const MotionMark& mark) {
    for (const fs::path& motion : {directory.kept_motion(), directory.store()}) {
        if (holds_motion(motion, mark)) return motion;
    }
    return std::nullopt;
}

// Of the stage after so many, with its motion.
std::optional<KeptRun> kept_within(const RunDirectory& directory, int stages) {
    std::string why;
    std::optional<StageMark> mark =
        read_stage_mark(directory.stage_mark(), directory.stage_keys(), stages, why);
    if (mark) {
        if (const auto motion = motion_of(directory, mark->motion)) {
            return KeptRun{std::nullopt, std::move(mark), *motion};
        }
        why = kMotionDamaged;
    }
    // Of a run that is changed it may be of a stage that was.
    if (!why.empty() && !directory.is_changed()) {
        log_warning("{}: {}, so stage {} begins anew", directory.stage_mark().string(), why,
                    stages + 1);
    }
    return std::nullopt;
}

}  // namespace

std::optional<KeptRun> kept_by_earlier_run(const RunDirectory& directory) {
    if (directory.is_anew()) return std::nullopt;
    std::string why;
    std::optional<Reached> reached =
        read_checkpoint(directory.checkpoint(), directory.stage_keys(), why);
    const auto stages = static_cast<std::size_t>(reached ? reached->stages : 0);
    if (why.empty() && stages + 1 < directory.stage_keys().size()) {
        if (auto kept = kept_within(directory, static_cast<int>(stages))) {
            kept->reached = std::move(reached);
            return kept;
        }
    }
    if (reached) {
        if (const auto motion = motion_of(directory, reached->motion)) {
            return KeptRun{std::move(reached), std::nullopt, *motion};
        }
        why = kMotionDamaged;
    }
    if (directory.is_changed()) {
        fail(ExitCode::foreign, "{}: {}; choose another --out, or --fresh to throw that run away",
             directory.checkpoint().string(), why);
    }
    if (!why.empty()) {
        log_warning("{}: {}, so the run begins anew", directory.checkpoint().string(), why);
    }
    return std::nullopt;
}

}  // namespace swage
