// SPDX-License-Identifier: GPL-3.0-or-later
// What the user says about one execution, beside the scene.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace swage {

// Stills, both ends included. Frame 1 is the untouched start; numbers go on over all stages.
struct FrameRange {
    int first = 1;
    int last = 1;
};

// Throws Error(command_line) where a run of so many frames has not all of these. `first_frame`:
// what the first is called.
inline void refuse_frames_beyond(int count, const FrameRange& wanted, int first_frame) {
    if (wanted.first >= 1 && wanted.last <= count) return;
    const int later = first_frame - 1;
    std::string asked = fmt::format("{}", wanted.first + later);
    if (wanted.last != wanted.first) asked += fmt::format("-{}", wanted.last + later);
    fail(ExitCode::command_line, "--frames {} is out of range: the run has the frames {} to {}",
         asked, 1 + later, count + later);
}

// What becomes of a run that stands in the directory already.
enum class EarlierRun {
    finish,   // it is this one and is brought to its end; another is refused
    extend,   // another is gone on from up to its first stage that is another now
    replace,  // it goes, whatever it is
};

struct RunOptions {
    std::filesystem::path out;           // the run directory
    std::vector<std::string> overrides;  // "key=value" as given; part of what makes the run
    std::vector<std::string> warnings{}; // of the reading of the scene, for the record
    std::optional<FrameRange> frames;    // draw only these; none: all
    bool draw = true;                    // false: no picture, and nothing of OpenGL is touched
    EarlierRun earlier = EarlierRun::finish;
    std::optional<double> keep_every{};  // keeps a stage that it is within after so long [s]
    bool insist = false;                 // run even if it seems to need more than there is
};

}  // namespace swage
