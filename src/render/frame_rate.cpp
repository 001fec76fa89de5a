// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_rate.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace swage {

namespace {

constexpr int kSlowed[] = {24, 30, 48, 60, 120};
constexpr double kRounded = 0.0045;  // 23.98 is 24000/1001 to this

std::optional<double> number_in(std::string_view text) {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
}

}  // namespace

std::optional<FrameRate> frame_rate_of(double value) {
    if (!(value >= 1 && value <= kMostFramesPerSecond)) return std::nullopt;
    if (value == std::floor(value)) return FrameRate{static_cast<int>(value), 1};
    for (const int whole : kSlowed) {
        const FrameRate slowed{1000 * whole, 1001};
        if (std::abs(value - slowed.value()) < kRounded) return slowed;
    }
    return std::nullopt;
}

std::optional<FrameRate> frame_rate_named(std::string_view text) {
    const std::size_t slash = text.find('/');
    if (slash == std::string_view::npos) {
        const std::optional<double> value = number_in(text);
        return value ? frame_rate_of(*value) : std::nullopt;
    }
    const std::optional<double> frames = number_in(text.substr(0, slash)),
                                seconds = number_in(text.substr(slash + 1));
    if (!frames || !seconds || !(*seconds > 0)) return std::nullopt;
    const std::optional<FrameRate> rate = frame_rate_of(*frames / *seconds);
    // A ratio is meant as it stands.
    if (!rate || *frames * rate->seconds != *seconds * rate->frames) return std::nullopt;
    return rate;
}

std::string frame_rate_text(const FrameRate& rate) {
    return rate.is_whole() ? std::to_string(rate.frames) : fmt::format("{:.6g}", rate.value());
}

std::string frame_rate_ratio(const FrameRate& rate) {
    return rate.is_whole() ? std::to_string(rate.frames)
                           : fmt::format("{}/{}", rate.frames, rate.seconds);
}

}  // namespace swage
