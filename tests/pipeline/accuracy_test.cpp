// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/accuracy.h"

#include <fmt/format.h>

#include "base/units.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("the accuracy told of a resolution is the worst that was measured, and of second order") {
    // swage verify oblique-bar oblique-rod, worst direction.
    for (const auto& [cells, bending, torsion] :
         {std::tuple(4.0, 0.0562, 0.0682), std::tuple(8.0, 0.0135, 0.0193)}) {
        CHECK(accuracy_at(cells).bending >= bending);
        CHECK(accuracy_at(cells).bending < 1.2 * bending);
        CHECK(accuracy_at(cells).torsion >= torsion);
        CHECK(accuracy_at(cells).torsion < 1.2 * torsion);
    }
    const int enough = accuracy_at(4).cells_for_percent;
    CHECK(accuracy_at(enough).torsion <= 0.01);
    CHECK(accuracy_at(enough).bending <= 0.01);
    CHECK(accuracy_at(enough - 1).torsion > 0.01);
}

TEST_CASE("what is told to resolve a break does: so many cells, or so much toughness") {
    Material glass;
    glass.name = "glass";
    glass.young_modulus = 70e9, glass.strength = 45e6, glass.toughness = 8;
    const double spacing = 2e-3, cells = 10;
    const std::string told = strength_warning(glass, spacing, cells);
    const int across = resolved_strength(glass, spacing, cells).cells_for_whole;
    CHECK(told.find(fmt::format("across = {} would suffice", across)) != std::string::npos);
    CHECK(strength_warning(glass, spacing * cells / across, across) == "");
    CHECK(strength_warning(glass, spacing * cells / (across - 1), across - 1) != "");
    const std::size_t at = told.find("a toughness of ");
    REQUIRE(at != std::string::npos);
    Material tough = glass;
    tough.toughness = parse_quantity(told.substr(at + 15), Quantity::toughness);
    CHECK(tough.toughness > glass.toughness);
    CHECK(strength_warning(tough, spacing, cells) == "");
    tough.toughness *= 0.97;
    CHECK(strength_warning(tough, spacing, cells) != "");
}

TEST_CASE("where no mold is fine enough for a break only more toughness is told to do") {
    Material brittle;
    brittle.young_modulus = 210e9, brittle.strength = 1e9, brittle.toughness = 1e-9;
    CHECK(resolved_strength(brittle, 7e-3, 3).cells_for_whole > 1000000000);
    const std::string told = strength_warning(brittle, 7e-3, 3);
    INFO(told);
    CHECK(told.find("across") == std::string::npos);
    CHECK(told.find("no cell size is fine enough; at this one it takes a toughness of ") !=
          std::string::npos);
}

TEST_CASE("cells that a mold may not have are not told to be enough") {
    Material glass;
    glass.name = "glass";
    glass.young_modulus = 70e9, glass.strength = 45e6, glass.toughness = 8;
    const int enough = resolved_strength(glass, 2e-3, 10).cells_for_whole;
    const auto told = [&](double most) {
        return strength_warning(glass, 2e-3, 10, "[mold]", {.across = most});
    };
    const std::string advice = fmt::format("[mold] across = {} would suffice", enough);
    CHECK(told(enough).find(advice) != std::string::npos);
    CHECK(told(enough - 1).find("would suffice") == std::string::npos);
    CHECK(told(enough - 1)
              .find(fmt::format("no lattice within its cell_limit is fine enough ([mold] "
                                "across = {} would be); at this one it takes a "
                                "toughness of ",
                                enough)) != std::string::npos);
}
