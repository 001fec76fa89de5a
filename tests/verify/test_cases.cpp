// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "tests/catch.h"
#include "tests/shared/bytes_of.h"
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

TEST_CASE("what falls short of a least value is missed, and the page has its plots") {
    CHECK(!at_least("x", 0, 5, 7).missed());
    CHECK(at_least("x", 0, 5, 4.9).missed());
    CHECK(at_least("x", 0, 5, std::nan("")).missed());
    Case c{"made-up", "", "", 0, true, {}};
    c.run = [](bool, Values& values) {
        values.draw({"history", "time [s]", "step [s]", {{"a < b", {{0, 1e-3}, {1, 1e-5}}}}});
        values.draw({"nothing", "time [s]", "step [s]", {}});
    };
    const std::string page = verified_page({{c, run_case(c, false)}});
    CHECK(page.find("history: step [s]") != std::string::npos);
    CHECK(page.find("<title>a &lt; b</title>") != std::string::npos);
    CHECK(page.find("nothing: ") == std::string::npos);
    CHECK(page.find("nan") == std::string::npos);
}

TEST_CASE("an absolute error has the unit of its value, a share of something is in per cent") {
    Case c{"made-up", "", "", 0, true, {}};
    c.run = [](bool, Values& values) {
        values.add(absolute("creep in 10 s [m]", 3, 0, 2.67763e-5, 1e-4));
        values.add(absolute("bounces", 4, 3, 5, 1));
        values.add(as_share("energy gained, share", 5, 0.2, 0.23, 0.05));
        values.add(absolute("force / E a^2", 6, 0, 3e-14, 1e-12));
        values.add(relative("length [m]", 7, 2, 2.02, 0.02));
    };
    const std::vector<Verified> all = {{c, run_case(c, false)}};
    CHECK(verified_markdown(all).find("| 3: 2.68e-05 m (0.0001 m), 4: **2** (1), 5: 3 % (5 %), "
                                      "6: 3.0e-14 (1.0e-12), 7: 1 % (2 %) |") != std::string::npos);
    CHECK(verified_text(all).find("2.68e-05 m  0.0001 m") != std::string::npos);
    CHECK(verified_page(all).find("<td>2.68e-05 m</td><td>0.0001 m</td>") != std::string::npos);
}

TEST_CASE("where an error is nothing no order is shown") {
    Case c{"made-up", "", "", 0, true, {}};
    c.run = [](bool, Values& values) {
        for (int across : {2, 4}) values.add(absolute("x", across, 0, 0, 1));
        for (int across : {2, 4}) values.add(absolute("y", across, 0, 4 - across, 3));
        for (int across : {2, 4}) values.add(absolute("z", across, 0, across - 2, 3));
        for (int across : {2, 4}) values.add(relative("w", across, 1, 1 + 0.1 / across, 3));
    };
    const std::vector<Verified> all = {{c, run_case(c, false)}};
    for (const std::string& text : {verified_text(all), verified_page(all)}) {
        CHECK(text.find("nan") == std::string::npos);
        CHECK(text.find("inf") == std::string::npos);
    }
    CHECK(verified_page(all).find(", order -<") != std::string::npos);
    CHECK(verified_page(all).find(", order 1.00<") != std::string::npos);
}

TEST_CASE("the README's table has a row for every case, and the command writes such rows") {
    const std::string whole = test::bytes_of(std::string(SWAGE_SOURCE_DIR) + "/README.md");
    const std::size_t section = whole.find("## How right it is");
    REQUIRE(section != std::string::npos);
    const std::string readme = whole.substr(section, whole.find("\n## ", section) - section);
    std::size_t rows = 0;
    for (std::size_t at = readme.find("\n| `"); at != std::string::npos;
         at = readme.find("\n| `", at + 1)) {
        ++rows;
    }
    const std::vector<Case> cases = verification_cases();
    CHECK(rows == cases.size());
    for (const Case& c : cases) {
        INFO(c.name);
        const std::size_t row = readme.find("\n| `" + c.name + "` | " + c.help + " | ");
        REQUIRE(row != std::string::npos);
        CHECK(readme.substr(row + 1, readme.find('\n', row + 1) - row - 1)
                  .ends_with(" | " + c.source + " |"));
        Result result;
        result.value = {relative("x", 4, 1, 1.01, 0.02), relative("y", 4, 1, 1.05, 0.1),
                        relative("x", 8, 1, 1.03, 0.02)};
        CHECK(verified_markdown({{c, result}}).find("| 4: 1 % (2 %), 8: **3 %** (2 %) |") !=
              std::string::npos);
    }
}
