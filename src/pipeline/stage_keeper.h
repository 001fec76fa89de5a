// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps a stage at the end of a frame (pipeline/stage_mark.h) whenever so much has been worked
// since the last time that keeping it is little beside it. When that is changes nothing of the
// results.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/stopwatch.h"
#include "pipeline/motion_recorder.h"
#include "pipeline/run_directory.h"
#include "pipeline/stage_mark.h"

namespace swage {

inline constexpr double kLeastKept = 5;  // [s] of work; less is soon done again

// Whether a stage can be set up again as it began: at the start of a run always.
enum class StageStart { is_kept, is_lost };

class StageKeeper {
  public:
    // The references must outlive it. `every`: keeps it after so long [s]; none: as above. `note`:
    // called once it was kept.
    StageKeeper(const RunDirectory& directory, MotionRecorder& recorder, Stopwatch& watch,
                std::optional<double> every, std::function<void()> note)
        : directory_(directory),
          recorder_(recorder),
          watch_(watch),
          every_(every),
          note_(std::move(note)) {}

    // One begins after so many, or goes on from this frame.
    void begin(int stages, std::optional<int> frame, StageStart start);
    bool is_due() const;
    // Where that cannot be written it is told, and nothing more is kept of this stage.
    void keep(int frame, const std::vector<WorkPiece>& bodies,
              const std::function<void(ByteWriter&)>& state);
    // The stage is done, or what is kept of it serves nothing.
    void forget();

    // Of the run, that the present stage can be gone on from; none: its start.
    std::optional<int> frame() const { return frame_; }
    // Of all stages that could not be kept.
    const std::vector<std::string>& warnings() const { return warnings_; }

  private:
    using Clock = std::chrono::steady_clock;

    const RunDirectory& directory_;
    MotionRecorder& recorder_;
    Stopwatch& watch_;
    std::optional<double> every_;
    std::function<void()> note_;
    int stages_ = 0;
    bool can_ = false;
    std::optional<int> frame_;
    Clock::time_point since_;  // it was kept or begun
    double cost_ = 0;          // of keeping it the last time [s]
    std::vector<std::string> warnings_;
};

}  // namespace swage
