// SPDX-License-Identifier: GPL-3.0-or-later
// How many frames a second a film has: a whole number, or one of those that television made of one,
// a thousandth slower to the digit (SMPTE ST 12-1).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace swage {

struct FrameRate {
    int frames = 30, seconds = 1;  // so many in so many: 24000 in 1001 is what is called 23.976

    double value() const { return static_cast<double>(frames) / seconds; }
    bool is_whole() const { return seconds == 1; }
    bool operator==(const FrameRate&) const = default;
};

inline constexpr int kMostFramesPerSecond = 240;
inline constexpr int kLargestFirstFrame = 1'000'000;  // what a run may call its first frame
inline constexpr const char* kFrameRateForm =
    "whole number, 1 to 240, or 23.976, 29.97, 47.952, 59.94 or 119.88";

// What is meant by a number of frames a second, also where it was rounded to two digits (23.98);
// none where no film has so many.
std::optional<FrameRate> frame_rate_of(double value);
// The same of a text, which may also say "24000/1001".
std::optional<FrameRate> frame_rate_named(std::string_view text);

// As people call it: "24", "23.976". As ffmpeg and OpenEXR have it: "24", "24000/1001".
std::string frame_rate_text(const FrameRate& rate);
std::string frame_rate_ratio(const FrameRate& rate);

}  // namespace swage
