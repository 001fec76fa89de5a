// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/limit_watch.h"

#include "tests/catch.h"

using namespace swage;

TEST_CASE("the most that a part bore is told with its instant, which may lie between two rows") {
    StageSpec stage;
    stage.name = "1-press";
    Machine machine;
    machine.spec.limit = {{"plate", 100, false, {}}};
    machine.apparatus.limit = {{0, 100}};
    const auto told_of = [&](const std::vector<std::pair<int, double>>& legs) {
        LimitWatch watch(stage, machine);
        for (std::size_t n = 0; n < legs.size(); ++n) {
            FrameReport report;
            report.load.resize(1);
            report.load[0].force = {0, legs[n].second, 0};
            const bool within = n + 1 < legs.size() && legs[n + 1].first == legs[n].first;
            watch.look(legs[n].first, report, within);
        }
        return watch.warnings(true).at(0);
    };
    const std::string never = "1-press: plate never reached its limit of 100 N: ";
    CHECK(told_of({{2, 3}, {2, 8}, {3, 7}}) == never + "the most that it bore was 8 N, in frame 2");
    CHECK(told_of({{2, 3}, {3, 9}, {3, 7}}) ==
          never + "the most that it bore was 9 N, on the way to frame 3");
    CHECK(told_of({{2, 0}}) == never + "it bore nothing");
}
