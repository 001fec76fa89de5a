// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("a time is rounded before it is told in parts, so that no part is a whole next one") {
    CHECK(seconds_text(0) == "0.0 s");
    CHECK(seconds_text(9.94) == "9.9 s");
    CHECK(seconds_text(9.97) == "10 s");
    CHECK(seconds_text(59.4) == "59 s");
    CHECK(seconds_text(59.7) == "1 min 0 s");
    CHECK(seconds_text(61.2) == "1 min 1 s");
    CHECK(seconds_text(119.7) == "2 min 0 s");
    CHECK(seconds_text(3599.7) == "1 h 0 min");
    CHECK(seconds_text(3600 + 59.6 * 60) == "2 h 0 min");
    CHECK(seconds_text(1234 * 3600) == "1,234 h 0 min");
}
