// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of a run, drawn from its motion file: stills, passes beside them, film, sheet.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "base/stopwatch.h"
#include "pipeline/best_view.h"
#include "pipeline/frame_store.h"
#include "pipeline/passes.h"
#include "pipeline/run_directory.h"
#include "pipeline/run_options.h"
#include "render/settings.h"

namespace swage {

inline constexpr int kSheetPictures = 20;       // on the sheet, about
inline constexpr int kSheetPictureWidth = 384;  // [pixel]

struct DrawOutcome {
    std::string renderer;  // what OpenGL calls itself
    int width = 0, height = 0;
    FrameRange frames;
    int first_frame = 1;             // what the first of the run is called
    bool film = false;               // one was written
    std::optional<ChosenView> view;  // where angles of the camera were open
    std::vector<PicturePass> passes;
    std::optional<SkinField> color;
    std::array<double, 2> color_range{};  // of that
    std::vector<std::string> warning;     // all told already
};

// Opens and closes an OpenGL context with what pictures are drawn into, so that a run that cannot
// be drawn is refused before it is simulated. Throws Error(output).
void check_drawing(const RenderSettings& settings);

// Throws Error(command_line) when the run has no such frames, Error(output), Interrupted. Only
// whole files appear.
DrawOutcome draw_run(const FrameStore& store, const RenderSettings& settings,
                     const FrameRange& frames, const DrawnFiles& files, Stopwatch& watch,
                     const RunNames& names = {});

}  // namespace swage
