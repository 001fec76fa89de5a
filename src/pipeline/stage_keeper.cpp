// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_keeper.h"

#include <algorithm>

#include "base/failure.h"
#include "base/log.h"

namespace swage {

namespace {

constexpr double kTimes = 50;  // what keeping takes, until it is due again: a fiftieth of the time

}  // namespace

void StageKeeper::begin(int stages, std::optional<int> frame, StageStart start) {
    stages_ = stages;
    frame_ = frame;
    can_ = start == StageStart::is_kept;
    since_ = Clock::now();
}

bool StageKeeper::is_due() const {
    const double worked = std::chrono::duration<double>(Clock::now() - since_).count();
    return can_ && worked >= every_.value_or(std::max(kLeastKept, kTimes * cost_));
}

void StageKeeper::keep(int frame, const std::vector<WorkPiece>& bodies,
                       const std::function<void(ByteWriter&)>& state) {
    const auto lap = watch_.lap("keep");
    const Clock::time_point start = Clock::now();
    try {
        make_folder(directory_.stage_mark().parent_path());
        recorder_.keep(directory_.kept_motion());
        StageMark mark;
        mark.stages = stages_;
        mark.frame = frame;
        mark.motion = recorder_.mark();
        mark.skin = recorder_.skins();
        mark.seconds = watch_.phases();
        write_stage_mark(directory_.stage_mark(), directory_.stage_keys(), mark, bodies, state);
        frame_ = frame;
        note_();
    } catch (const std::exception& error) {
        const std::optional<Error> failure = failure_of(error);
        if (!failure) throw;
        warnings_.push_back(
            fmt::format("{}; what comes of this stage is not kept", failure->what()));
        log_warning("{}", warnings_.back());
        can_ = false;
    }
    since_ = Clock::now();
    cost_ = std::chrono::duration<double>(since_ - start).count();
}

void StageKeeper::forget() {
    std::error_code ignored;
    std::filesystem::remove(directory_.stage_mark(), ignored);
    frame_.reset();
}

}  // namespace swage
