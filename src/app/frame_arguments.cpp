// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/frame_arguments.h"

namespace swage {

void add_frame_arguments(CLI::App& command, FrameArguments& given) {
    command
        .add_option("--frames", given.frames,
                    "only the frames A to B, A, or A- to the end; 1, or --first-frame, is the "
                    "start. They keep their numbers, and the view frames the whole run")
        ->type_name("A-B")
        ->each([](const std::string& text) { parse_frame_range(text); });
    command
        .add_option("--fps", given.rate,
                    "frames a second (default: as in the scene); 23.976 is exactly 24000/1001, and "
                    "so 29.97, 47.952, 59.94 and 119.88")
        ->type_name("RATE")
        ->each([](const std::string& text) { parse_frame_rate(text); });
    command
        .add_option(
            "--first-frame", given.first,
            "number of the first frame, the start, in names, as a time code and in --frames "
            "(default: as in the scene, else 1)")
        ->check(CLI::Range(1, kLargestFirstFrame));
}

void set_frames(const FrameArguments& given, RenderSettings& settings) {
    if (!given.rate.empty()) settings.frame_rate = parse_frame_rate(given.rate);
    if (given.first) settings.first_frame = *given.first;
}

FrameRange wanted_frames(const FrameArguments& given, const RenderSettings& settings, int count) {
    if (given.frames.empty()) return {1, count};
    return parse_frame_range(given.frames, count, settings.first_frame);
}

}  // namespace swage
