// SPDX-License-Identifier: GPL-3.0-or-later
// Options that say which frames of a run are wanted, how fast they go and how they are numbered.
#pragma once

#include <optional>
#include <string>

#include "app/command.h"
#include "render/settings.h"

namespace swage {

struct FrameArguments {
    std::string frames, rate;
    std::optional<int> first;
};

void add_frame_arguments(CLI::App& command, FrameArguments& given);
// What is given takes the place of what the settings say.
void set_frames(const FrameArguments& given, RenderSettings& settings);
// Those that are wanted, counted from 1; the settings' first is what the run's first is called.
FrameRange wanted_frames(const FrameArguments& given, const RenderSettings& settings, int count);

}  // namespace swage
