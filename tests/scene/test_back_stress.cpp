// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

namespace {

// Line 5 on is `lines`.
Parts metal(const std::string& lines) {
    return with(&Parts::material, "[material]\nname = \"aluminium\"\n" + lines + "\n");
}

}  // namespace

TEST_CASE("a back stress that cannot be is refused at its place, with what would do") {
    check_all({
        {"one without its strain",
         metal("back_stress = \"100 MPa\""),
         {"5:15: back_stress needs back_strain: the plastic strain over which it builds up, such "
          "as 0.01"}},
        {"a strain alone",
         metal("back_strain = 0.01"),
         {"5:15: warning: back_strain has no effect without back_stress"}},
        {"rubber, which does not yield",
         material("back_stress = \"1 MPa\"\nback_strain = 0.01"),
         {"5:15: warning: back_stress has no effect without yield_stress"}},
        {"springs",
         metal("mechanics = \"springs\"\nback_stress = \"100 MPa\"\nback_strain = 0.01"),
         {"6:15: springs have no back stress: use mechanics = \"cells\" or back_stress = 0"}},
        {"as steep as the matter is stiff",
         metal("back_stress = \"100 MPa\"\nback_strain = 0.001"),
         {"5:15: a back_stress of 100 MPa over a back_strain of 0.001 builds up by 100 GPa: at "
          "most 0.5 of young_modulus"}},
        {"more than there is, in the end",
         metal("yield_stress = \"200 MPa\"\nhardening = 0\nback_stress = \"210 MPa\"\n"
               "back_strain = 0.01"),
         {"7:15: a back_stress of 210 MPa leaves -10 MPa of the flow stress at large strain, and "
          "at least "
          "10 MPa is needed: give less, or let hardening or flow_curve rise by as much, as {s0 = "
          "\"200 MPa\", Q = \"210 MPa\", b = 100} does"}},
        {"more than there is, for a while",
         metal("yield_stress = \"200 MPa\"\nhardening = \"1 GPa\"\nback_stress = \"300 MPa\"\n"
               "back_strain = 0.02"),
         {"7:15: a back_stress of 300 MPa leaves -25.8"}},
        {"by what the scene takes away",
         metal("back_stress = \"100 MPa\"\nback_strain = 0.01\nyield_stress = \"90 MPa\"\n"
               "hardening = 0"),
         {"5:15: a back_stress of 100 MPa leaves"}},
        {"out of range",
         metal("back_stress = \"100 MPa\"\nback_strain = 40"),
         {"6:15: back_strain = 40 is out of range: it must be 1e-06 to 10"}},
    });
    Parts two = metal("back_stress = \"100 MPa\"\nback_strain = 0.01");
    two.rest += "[[inset]]\nname = \"rubber\"\nfrom = [0, 0, 0.5]\nto = [1, 1, 1]\n";
    CHECK(mistakes_in(two.text()).find("cells of two materials have no back stress") !=
          std::string::npos);
}

TEST_CASE("a back stress reaches its material, and a scene can take it away") {
    const SceneFolder scratch;
    scratch.write("materials.toml", R"([bent]
young_modulus = "200 GPa"
density = 7800
yield_stress = "300 MPa"
hardening = "1 GPa"
back_stress = "150 MPa"
back_strain = 0.008
)");
    const auto read = [&](const std::string& more) {
        const Parts parts = with(&Parts::material, "[material]\nname = \"bent\"\n" + more);
        const SceneReading reading =
            read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
        INFO(told(reading.mistakes, scratch.path()));
        REQUIRE(reading.scene);
        return reading.scene->work_piece().material;
    };
    const Material bent = read("");
    CHECK(bent.back_stress == 150e6);
    CHECK(bent.back_strain == 0.008);
    CHECK(bent.shifts());
    CHECK_FALSE(read("back_stress = 0\n").shifts());
    CHECK_FALSE(read("yield_stress = inf\n").shifts());
    CHECK(read("back_stress = \"100 MPa\"\n").back_strain == 0.008);
}
