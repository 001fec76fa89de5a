// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "laws/flow_forms.h"
#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("a flow curve that is none is refused at its place, with what is wanted") {
    check_all({
        {"a curve beside what it says",
         material("yield_stress = 3\nhardening = 1\nflow_curve = [[0, 3], [1, 4]]"),
         {"5:16: yield_stress is given by the first point of flow_curve: leave it out",
          "6:13: hardening is given by flow_curve: leave one of them out"}},
        {"a curve that is none",
         material("flow_curve = \"250 MPa\""),
         {"5:14: flow_curve is text; expected a list of points [strain, \"stress\"], such as"}},
        {"a curve of one point",
         material("flow_curve = [[0, \"250 MPa\"]]"),
         {"5:14: flow_curve: it needs at least two points; for flow at constant stress use "
          "yield_stress instead"}},
        {"a point that is no pair",
         material("flow_curve = [[0, \"250 MPa\"], [0.1]]"),
         {"5:31: flow_curve: each point must be a pair [strain, \"stress\"]"}},
        {"a curve that begins late",
         material("flow_curve = [[0.002, \"250 MPa\"], [0.1, \"300 MPa\"]]"),
         {"5:16: flow_curve: the first point is where plastic flow begins: its plastic strain must "
          "be 0"}},
        {"a curve that goes back",
         material("flow_curve = [[0, \"250 MPa\"], [0.1, \"300 MPa\"], [0.1, \"310 MPa\"]]"),
         {"5:50: flow_curve: a strain of 0.1 after one of 0.1: strains must rise, each by more "
          "than 1e-09"}},
        {"a curve that falls",
         material("flow_curve = [[0, \"250 MPa\"], [0.1, \"240 MPa\"]]"),
         {"5:37: flow_curve: the stress falls from 250 MPa to 240 MPa: matter that softens"}},
        {"a unit forgotten of one",
         material("flow_curve = [[0, \"250 MPa\"], [0.1, 300], [0.2, \"400 MPa\"]]"),
         {"5:37: flow_curve: 300 without a unit is 300 Pa, next to \"400 MPa\": is a unit missing, "
          "as in \"300 MPa\"?"}},
        {"a unit forgotten of the first, and in a text",
         material("flow_curve = [[0, \"250\"], [0.1, \"300 N/mm2\"]]"),
         {"5:19: flow_curve: 250 without a unit is 250 Pa, next to \"300 N/mm2\": is a unit "
          "missing, as in \"250 N/mm2\"?"}},
        {"a unit forgotten in a form",
         material("flow_curve = {A = \"90 MPa\", B = 292, n = 0.31}"),
         {"5:33: flow_curve: 292 without a unit is 292 Pa, next to \"90 MPa\""}},
        {"strain in percent",
         material("flow_curve = [[0, \"250 MPa\"], [20, \"300 MPa\"]]"),
         {"5:32: flow_curve = 20 is out of range: it must be 0 to 10"}},
        {"a curve of another quantity",
         material("flow_curve = [[0, \"250 MPa\"], [0.1, \"3 mm\"]]"),
         {"5:40: flow_curve: \"3 mm\" is a length; expected a stress"}},
        {"a form that is none",
         material("flow_curve = {C = 3}"),
         {"5:14: flow_curve is a list of points"}},
        {"half a form",
         material("flow_curve = {K = \"500 MPa\", n = 0.2}"),
         {"5:14: flow_curve needs \"e0\": as in flow_curve = {K = "}},
        {"a form with more than it takes",
         material("flow_curve = {K = \"0.5 MPa\", e0 = 0.01, n = 0.2, m = 0.1}"),
         {"5:50: unknown key \"m\" in flow_curve"}},
        {"a form out of range",
         material("flow_curve = {A = \"90 MPa\", B = \"292 MPa\", n = 0.01}"),
         {"5:48: n = 0.01 is out of range: it must be 0.1 to 1"}},
        {"foam that is told a curve",
         material("elasticity = \"storakers\"\nflow_curve = [[0, 3], [1, 4]]"),
         {"storakers matter does not yield"}},
    });
}

TEST_CASE("a flow curve in pascals beside other units is taken as it says") {
    for (const char* curve :
         {"[[0, 250e6], [0.1, \"300 MPa\"]]", "[[0, \"250e6\"], [0.1, \"3e8 Pa\"]]",
          "[[0, 250e6], [0.1, 300e6]]", "{A = \"90 MPa\", B = 0, n = 1}"}) {
        INFO(curve);
        CHECK(mistakes_in(
                  with(&Parts::material,
                       std::string("[material]\nname = \"copper\"\nflow_curve = ") + curve + "\n")
                      .text())
                  .empty());
    }
}

namespace {

// A scene of this section [material], beside a file of materials that has one with a curve.
SceneReading read_with(const SceneFolder& scratch, const std::string& section) {
    scratch.write("materials.toml", R"([drawn]
young_modulus = "200 GPa"
density = 7800
flow_curve = [[0, "200 MPa"], [0.1, "300 MPa"]]
)");
    const Parts parts = with(&Parts::material, "[material]\n" + section);
    return read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
}
Material material_of(const std::string& section) {
    const SceneFolder scratch;
    const SceneReading reading = read_with(scratch, section);
    INFO(section << told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    return reading.scene->work_piece().material;
}

}  // namespace

TEST_CASE("a flow curve reaches its material point by point, and a form as points along it") {
    const Material points = material_of(
        "name = \"structural_steel\"\nflow_curve = [[0, \"250 MPa\"], [0.02, 3e8], [1, 3e8]]\n");
    REQUIRE(points.flow_curve.size() == 3);
    CHECK(points.flow_curve[1].strain == 0.02);
    CHECK(points.flow_curve[1].stress == 3e8);
    CHECK(points.yield_stress == 250e6);
    CHECK(points.hardening == 0);

    const auto at = [](const Material& m, double strain) {
        std::size_t n = 1;
        while (m.flow_curve[n].strain < strain) ++n;
        const auto& [from, low] = m.flow_curve[n - 1];
        const auto& [to, high] = m.flow_curve[n];
        return low + (high - low) * (strain - from) / (to - from);
    };
    const std::string start = "young_modulus = 2e11\ndensity = 7800\nflow_curve = ";
    const Material swift = material_of(start + "{K = \"530 MPa\", e0 = 0.004, n = 0.23}\n");
    CHECK(swift.yield_stress == Approx(530e6 * std::pow(0.004, 0.23)));
    CHECK(at(swift, 0.3) == Approx(530e6 * std::pow(0.304, 0.23)).epsilon(kFormError));
    const Material ludwik = material_of(start + "{A = \"90 MPa\", B = \"292 MPa\", n = 0.31}\n");
    CHECK(ludwik.yield_stress == Approx(90e6));
    CHECK(at(ludwik, 0.3) == Approx(90e6 + 292e6 * std::pow(0.3, 0.31)).epsilon(kFormError));
    const Material voce = material_of(start + "{s0 = \"140 MPa\", Q = \"160 MPa\", b = 9}\n");
    CHECK(voce.yield_stress == Approx(140e6));
    CHECK(at(voce, 0.3) == Approx(300e6 - 160e6 * std::exp(-2.7)).epsilon(kFormError));
}

TEST_CASE("what a scene says of yielding takes the place of a named material's curve") {
    CHECK(material_of("name = \"drawn\"\n").flow_curve.size() == 2);
    const Material never = material_of("name = \"drawn\"\nyield_stress = inf\n");
    CHECK(never.flow_curve.empty());
    CHECK_FALSE(never.yields());
    const Material linear = material_of("name = \"drawn\"\nyield_stress = 1e8\nhardening = 1e9\n");
    CHECK(linear.flow_curve.empty());
    CHECK(linear.yield_stress == 1e8);
    CHECK(linear.hardening == 1e9);
    // And the reverse.
    CHECK(
        material_of("name = \"structural_steel\"\nflow_curve = [[0, 1e8], [1, 2e8]]\n").hardening ==
        0);

    const SceneFolder scratch;
    SceneReading reading = read_with(scratch, "name = \"drawn\"\nyield_stress = 1e8\n");
    CHECK(told(reading.mistakes, scratch.path())
              .starts_with("s.toml:5:16: warning: yield_stress replaces the flow_curve of drawn"));
    reading = read_with(scratch, "name = \"drawn\"\nhardening = 1e8\n");
    CHECK(told(reading.mistakes, scratch.path())
              .starts_with("s.toml:5:13: drawn hardens by its flow_curve: give yield_stress beside "
                           "hardening, or another flow_curve"));
}

TEST_CASE("what flows at next to no stress, or at as much as it is stiff, lacks a unit") {
    const SceneFolder scratch;
    const auto warned = [&](const std::string& more) {
        const SceneReading reading =
            read_with(scratch, "young_modulus = \"200 GPa\"\ndensity = 7800\n" + more);
        return told(reading.mistakes, scratch.path()).find("is a unit missing") !=
               std::string::npos;
    };
    CHECK(warned("flow_curve = [[0, 200], [0.1, 300]]\n"));
    CHECK(warned("flow_curve = [[0, \"200 GPa\"], [0.1, \"300 GPa\"]]\n"));
    CHECK(warned("yield_stress = 200\n"));
    CHECK_FALSE(warned("yield_stress = \"200 MPa\"\n"));
    CHECK_FALSE(warned("yield_stress = inf\n"));
}
