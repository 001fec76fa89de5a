// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/kept_run.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "pipeline/stage_products.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDamaged = "is damaged";
constexpr const char* kMotionDamaged = "goes with a motion file that is damaged";

void tell(const fs::path& file, const std::string& why, int stage) {
    log_warning("{}: {}, so stage {} begins anew", file.string(), why, stage);
}

// What is whole and of this run may still have been made by somebody.
bool fits(const Reached& reached, const SceneSpec& scene, int stages) {
    const Json &matter = reached.matter, &stage = reached.stage;
    const auto says_frames = [](const Json& one) {
        const Json frames = one.is_object() ? one.value("frames", Json()) : Json();
        return frames.is_array() && frames.size() == 2 && frames[1].is_number_integer();
    };
    return reached.stages == stages && reached.bodies.size() == scene.body.size() &&
           matter.is_array() && matter.size() == scene.body.size() && stage.is_array() &&
           stage.size() == static_cast<std::size_t>(stages) &&
           std::all_of(stage.begin(), stage.end(), says_frames);
}

// The file that holds it, if any does.
std::optional<fs::path> motion_of(const RunDirectory& directory, const MotionMark& mark) {
    for (const fs::path& motion : {directory.kept_motion(), directory.store()}) {
        if (holds_motion(motion, mark)) return motion;
    }
    return std::nullopt;
}

// Of the stage after so many, with its motion.
std::optional<KeptRun> kept_within(const SceneSpec& scene, const RunDirectory& directory,
                                   int stages) {
    std::string why;
    std::optional<StageMark> mark =
        read_stage_mark(directory.stage_mark(), directory.stage_keys(), stages, why);
    if (mark && mark->bodies.size() != scene.body.size()) {
        why = kDamaged;
    } else if (mark) {
        if (const auto motion = motion_of(directory, mark->motion)) {
            return KeptRun{std::nullopt, std::move(mark), *motion};
        }
        why = kMotionDamaged;
    }
    // Of a run that is changed it may be of a stage that was.
    if (!why.empty() && !directory.is_changed()) tell(directory.stage_mark(), why, stages + 1);
    return std::nullopt;
}

}  // namespace

std::optional<KeptRun> kept_by_earlier_run(const SceneSpec& scene, const RunDirectory& directory) {
    if (directory.is_anew()) return std::nullopt;
    const auto all = static_cast<int>(directory.stage_keys().size()) - 1;
    std::string why;
    for (int stages = all; stages >= 0; --stages) {
        std::optional<Reached> reached;
        if (stages > 0) {
            const fs::path file = directory.checkpoint(stages);
            std::error_code unknown;
            if (!fs::exists(file, unknown)) {
                if (directory.was_kept(stages)) tell(file, "is gone", stages);
                continue;
            }
            // Of a run that is changed it may be of a stage that was.
            if (directory.is_changed() && !is_kept(file, directory.stage_keys(), stages)) {
                if (directory.was_kept(stages)) tell(file, kDamaged, stages);
                continue;
            }
            std::string amiss;
            reached = read_checkpoint(file, directory.stage_keys(), amiss);
            if (reached && !fits(*reached, scene, stages)) {
                amiss = kDamaged;
            } else if (reached) {
                const fs::path gone = missing_product(scene, directory, stages);
                if (!gone.empty())
                    amiss = fmt::format("goes with {}, which is gone", gone.string());
            }
            if (!amiss.empty()) {
                why = amiss;
                tell(file, why, stages);
            }
            if (!reached || !amiss.empty()) continue;
        }
        // What is kept within a stage is of the one after all that were finished.
        if (why.empty() && stages < all) {
            if (auto kept = kept_within(scene, directory, stages)) {
                kept->reached = std::move(reached);
                return kept;
            }
        }
        if (!reached) break;
        if (const auto motion = motion_of(directory, reached->motion)) {
            return KeptRun{std::move(reached), std::nullopt, *motion};
        }
        why = kMotionDamaged;
        tell(directory.checkpoint(stages), why, stages);
    }
    if (directory.is_changed()) {
        fail(ExitCode::foreign,
             "{}: of what it has kept nothing is whole; choose another --out, or --fresh to throw "
             "that run away",
             directory.root().string());
    }
    return std::nullopt;
}

void forget_what_is_within(const RunDirectory& directory) {
    std::error_code ignored;
    fs::remove(directory.stage_mark(), ignored);
    fs::remove(directory.kept_motion(), ignored);
}

}  // namespace swage
