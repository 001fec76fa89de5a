// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_rate.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("what is called 23.976 is 24000 frames in 1001 seconds, and so its kin") {
    const std::pair<double, FrameRate> known[] = {
        {24, {24, 1}},          {30, {30, 1}},           {1, {1, 1}},
        {240, {240, 1}},        {23.976, {24000, 1001}}, {23.98, {24000, 1001}},
        {29.97, {30000, 1001}}, {47.952, {48000, 1001}}, {47.95, {48000, 1001}},
        {59.94, {60000, 1001}}, {119.88, {120000, 1001}}};
    for (const auto& [value, rate] : known) {
        INFO(value);
        CHECK(frame_rate_of(value) == rate);
        CHECK(frame_rate_of(rate.value()) == rate);
        CHECK(frame_rate_named(frame_rate_ratio(rate)) == rate);
        CHECK(frame_rate_named(frame_rate_text(rate)) == rate);
    }
    CHECK(frame_rate_text({24000, 1001}) == "23.976");
    CHECK(frame_rate_ratio({24000, 1001}) == "24000/1001");
    CHECK(frame_rate_ratio({25, 1}) == "25");
}

TEST_CASE("a rate that no film has is none") {
    for (const double value : {0.0, 0.5, -30.0, 12.5, 23.9, 24.1, 29.9, 240.5, 241.0}) {
        INFO(value);
        CHECK_FALSE(frame_rate_of(value).has_value());
    }
    for (const char* text :
         {"", "many", "24x", "24/0", "24/", "/1001", "24001/1001", "24000/1000.5", "nan"}) {
        INFO(text);
        CHECK_FALSE(frame_rate_named(text).has_value());
    }
    CHECK(frame_rate_named("24000/1000") == FrameRate{24, 1});
}
