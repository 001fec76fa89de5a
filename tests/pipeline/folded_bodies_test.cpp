// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/folded_bodies.h"

#include "tests/catch.h"

using namespace swage;

TEST_CASE("bodies that the same is said of are named once, many in a row by the first and last") {
    const std::vector<std::string> name = {"a", "b", "c", "d", "e", "f", "g"};
    const auto text = [&](const std::vector<std::size_t>& of) { return bodies_text(name, of); };
    CHECK(text({2}) == "c");
    CHECK(text({0, 1}) == "a and b");
    CHECK(text({1, 2, 3}) == "b to d");
    CHECK(text({0, 2, 3, 4, 5}) == "a and c to f");
    CHECK(text({0, 2, 4, 5, 6}) == "a, c, e to g");
    CHECK(text({0, 1, 2, 3, 4, 5, 6}) == "all 7 bodies");
}

TEST_CASE("what is found of several bodies is told once, with those that it is found of") {
    const std::vector<std::vector<std::string>> found = {{"x", "y"}, {"x"}, {}, {"x", "z", "z"}};
    const std::vector<FoldedText> told = folded(found);
    REQUIRE(told.size() == 3);
    CHECK(told[0].body == std::vector<std::size_t>{0, 1, 3});
    CHECK(told[1].text == "y");
    CHECK(told[2].body == std::vector<std::size_t>{3});
    CHECK(folded_warnings({"a", "b", "c", "d"}, found) ==
          std::vector<std::string>{"mold of a, b, d: x", "mold of a: y", "mold of d: z"});
    CHECK(folded_warnings({"work-piece"}, {{"x"}}) == std::vector<std::string>{"mold: x"});
}
