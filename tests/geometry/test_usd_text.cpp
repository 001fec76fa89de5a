// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/usd_text.h"

#include "tests/catch.h"

using namespace swage;

TEST_CASE("a path in USD may hold any number of @") {
    CHECK(usd_asset("./a.png") == "@./a.png@");
    CHECK(usd_asset("./a@b.png") == "@@@./a@b.png@@@");
    CHECK(usd_asset("./a@@@b.png") == "@@@./a\\@@@b.png@@@");
    CHECK(usd_asset("./@@@@@@@.png") == "@@@./\\@@@\\@@@@.png@@@");
}
