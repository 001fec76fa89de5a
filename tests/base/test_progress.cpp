// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/progress.h"

#include "tests/catch.h"

using namespace swage;

TEST_CASE("what is left is told from what has been done, and what takes long by how long it has") {
    CHECK(time_left_text(4, 6, 40, 0) == "1:00 left");
    CHECK(time_left_text(10, 0, 40, 0) == "0 s left");
    CHECK(time_left_text(4, 6, 40, 7) == "53 s left");
    CHECK(time_left_text(4, 1, 2, 300) == "0 s left, the next has taken 5:00 so far");
    CHECK(time_left_text(0, 10, 0, 3) == "begun");
    CHECK(time_left_text(0, 10, 0, 90) == "the next has taken 1:30 so far");
}
