// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/frame_account.h"

#include "tests/catch.h"

using namespace swage;

TEST_CASE("the account of a frame names what its solver did, and nothing else") {
    FrameReport rest;
    rest.body.resize(2);
    rest.pieces = 2;  // one of each body
    CHECK(frame_account(rest) == "nothing to do");
    rest.iterations = 1;
    rest.increments = 3;
    rest.halvings = 2;
    rest.residual = 1.23e-4;
    rest.severed = 7;
    rest.pieces = 3;
    CHECK(frame_account(rest) ==
          "1 iteration, 3 increments, 2 increments halved, 1.2e-04 of the push left over, 7 "
          "connections cut, 3 pieces");

    FrameReport motion;
    motion.body.resize(1);
    motion.steps = 250;
    motion.shortest_step = 1.5e-6;
    motion.rejected = 4;
    motion.asleep = 1;
    motion.broken = 1;
    CHECK(frame_account(motion) ==
          "250 steps, the shortest 1.5 us, 4 steps taken back, 1 body at rest, 1 connection "
          "broken");
}
