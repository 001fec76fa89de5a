// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "tests/catch.h"
#include "verify/table.h"

using namespace swage;

TEST_CASE("the quick cases of verification are within their bounds") {
    std::vector<Verified> all;
    for (const Case& c : verification_cases()) {
        if (c.quick) all.push_back({c, run_case(c, true)});
    }
    REQUIRE(all.size() > 3);
    INFO(verified_text(all));
    for (const Verified& one : all) {
        INFO(one.verification.name);
        CHECK(!one.result.missed);
        CHECK(!one.result.value.empty());
    }
}

TEST_CASE("a case beyond its bound, of too low an order or stopped early is missed") {
    const auto with = [](double least_order, std::vector<Value> given) {
        Case c{"made-up", "", "", least_order, true, {}};
        c.run = [given](bool, Values& values) {
            for (const Value& v : given) values.add(v);
        };
        return run_case(c, false);
    };
    const std::vector<Value> second_order = {relative("x", 2, 1, 1.04, 0.05),
                                             relative("x", 4, 1, 1.01, 0.05)};
    CHECK(!with(1.5, second_order).missed);
    CHECK(with(1.5, second_order).series.at(0).order == Approx(2));
    CHECK(with(2.5, second_order).missed);
    CHECK(with(0, {relative("x", 2, 1, 1.06, 0.05)}).missed);
    CHECK(with(0, {relative("x", 2, 1, std::nan(""), 0.05)}).missed);
    CHECK(!with(0, {told("x", 2, 1, 7)}).missed);
}
