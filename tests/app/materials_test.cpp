// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

TEST_CASE("what is told of a material is a material that a scene may give") {
    const Scratch scratch;
    put_text(scratch.path() / "materials.toml",
             "[mine]\nyoung_modulus = \"200 GPa\"\ndensity = 7800\nyield_stress = \"300 MPa\"\n"
             "back_stress = \"80 MPa\"\nback_strain = 0.02\nstickiness = \"3 kPa\"\n");
    const Outcome list = run_swage({"materials", "--json"}, scratch.path());
    REQUIRE(list.code == 0);
    const Json all = parse_json(list.out);
    CHECK(all.size() >= 33);
    const std::string table = run_swage({"materials"}, scratch.path()).out;
    const fs::path scene = put_small_scene(scratch.path());
    std::string rest = bytes_of(scene);
    const std::size_t from = rest.find("[material]"), to = rest.find("\n[", from);
    for (const char* name :
         {"structural_steel", "rubber", "foam", "glass", "clay", "ofhc_copper", "mine"}) {
        CHECK(table.find(std::string("  ") + name + " ") != std::string::npos);
        const std::string text = run_swage({"materials", name}, scratch.path()).out;
        INFO(text);
        // Of no name: nothing but what is told.
        const bool has_curve = text.find("curve") != std::string::npos;
        const std::size_t end = has_curve ? text.find('\n') : text.find('\n', text.find("name = "));
        std::string own = rest;
        own.replace(from, to - from, "[material]" + text.substr(end));
        put_text(scratch.path() / "own.toml", own);
        std::string named = rest;
        named.replace(from, to - from, std::string("[material]\nname = \"") + name + "\"\n");
        put_text(scratch.path() / "named.toml", named);
        const auto material = [&](const char* file, const char* out) {
            const Outcome run = run_swage({"run", file, "--no-render", "--out", out, "--set",
                                           "stage.1.frames=1", "--set", "stage.1.angle=0.1 deg"},
                                          scratch.path());
            INFO(run.err);
            REQUIRE(run.code == 0);
            Json told =
                parse_json(bytes_of(scratch.path() / out / "run.json"))["bodies"][0]["materials"];
            told[0].erase("name");
            return told;
        };
        CHECK(material("own.toml", (std::string(name) + "-own").c_str()) ==
              material("named.toml", (std::string(name) + "-named").c_str()));
    }
}

TEST_CASE("how a material looks is told as a scene may give it") {
    const Scratch scratch;
    const std::string copper = run_swage({"materials", "copper"}, scratch.path()).out;
    CHECK(copper.find("look = {color = [0.93, 0.66, 0.54], roughness = 0.3, metalness = 1, clear = "
                      "0}\n") != std::string::npos);
    const Outcome told = run_swage({"materials", "glass", "--json"}, scratch.path());
    const Json look = parse_json(told.out).at("look");
    CHECK(look.at("clear").get<double>() > 0.5);
    CHECK(look.at("color").at(1).get<double>() == Approx(0.98));
}

TEST_CASE("a material that is not there is answered by the nearest") {
    const Outcome outcome = run_swage({"materials", "ruber"});
    CHECK(outcome.code == 2);
    CHECK(outcome.err.find("did you mean \"rubber\"?") != std::string::npos);
}

TEST_CASE("a file of materials that has mistakes is no list of materials") {
    const Scratch scratch;
    put_text(scratch.path() / "materials.toml", "[goo]\ndensity = 1000\n");
    const Outcome outcome = run_swage({"materials", "goo"}, scratch.path());
    CHECK(outcome.code == 3);
    CHECK(outcome.err.find("materials.toml:1") != std::string::npos);
    CHECK(outcome.out.empty());
}
