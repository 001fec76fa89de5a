// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text.h"

#include <cmath>

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

TEST_CASE("counts and bytes are told in groups and units that read well") {
    CHECK(count_text(0) == "0");
    CHECK(count_text(999) == "999");
    CHECK(count_text(1000) == "1,000");
    CHECK(count_text(1234567) == "1,234,567");
    CHECK(bytes_text(1023) == "1023 bytes");
    CHECK(bytes_text(1024) == "1.0 KiB");
    CHECK(bytes_text(99.5 * 1024) == "99.5 KiB");
    CHECK(bytes_text(100 * 1024) == "100 KiB");
    CHECK(bytes_text(2.5 * (1 << 30)) == "2.5 GiB");
    CHECK(bytes_text(std::ldexp(5000, 50)) == "5000 PiB");
}

TEST_CASE("control characters are shown as what they are, letters of any alphabet as themselves") {
    CHECK(printable("a\tb\nc \u00e4 \u03bcm \U0001f600") == "a\tb\nc \u00e4 \u03bcm \U0001f600");
    CHECK(printable(std::string("\x1b[31mX\0\r\x7f", 9)) == "\\x1b[31mX\\x00\\x0d\\x7f");
    CHECK(printable("\u009b2J \u00a0") == "\\x9b2J \u00a0");
    CHECK(printable("\xc2") == "\xc2");
}
