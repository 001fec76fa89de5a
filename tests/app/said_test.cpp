// SPDX-License-Identifier: GPL-3.0-or-later
// What was said is taken at its word, and what is told of it is so.
#include <signal.h>

#include <chrono>
#include <thread>

#include "tests/app/resumed_run.h"
#include "tests/shared/scratch.h"

using namespace resumed;

namespace {

std::string loaded(const std::string& force, const std::string& fps) {
    return kMesh + "[material]\nname = \"structural_steel\"\n" + kMold + "[render]\nfps = " + fps +
           "\n[[stage]]\nmachine = \"hold\"\nframes = 1\n[[stage.load]]\non = \"right\"\n" + force +
           "\n[[stage.load]]\nfrom = [0.02, 0, 0]\nto = [\"4 cm\", \"2 cm\", \"2 cm\"]\n"
           "pressure = \"1 kPa\"\n";
}

}  // namespace

TEST_CASE("loads and rates that are said in other units are the same") {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), loaded("force = [0, \"-1 kN\", 0]", "23.976")),
                   out = scratch.path() / "run";
    REQUIRE(run(scene, out).code == 0);
    std::string same = loaded("force = [\"0 N\", -1e3, \"2 mN - 2 mN\"]", "\"24000/1001\"");
    same.replace(same.find("\"1 kPa\""), 7, "1000");
    same.replace(same.find("0.02, 0"), 7, "\"20 mm\", 0");
    put_text(scene, same);
    const Outcome again = run(scene, out);
    INFO(again.err);
    CHECK(again.code == 0);
    CHECK(says(again.err, "already complete"));
    put_text(scene, loaded("force = [0, \"-1.1 kN\", 0]", "24"));
    const Outcome other = run(scene, out);
    INFO(other.err);
    CHECK(other.code == 8);
    CHECK(says(other.err, "load"));
    CHECK(says(other.err, "render.fps"));
}

TEST_CASE("an empty text is no value of an option") {
    const Scratch scratch;
    const std::string bar = (scratch.path() / "bar.obj").string();
    for (const char* option : {"--length", "--division"}) {
        const Outcome outcome = run_swage({"make", "bar", option, "", "--out", bar});
        INFO(outcome.err);
        CHECK(outcome.code == 2);
        CHECK(says(outcome.err, option));
    }
    CHECK_FALSE(fs::exists(bar));
    const fs::path scene = put_small_scene(scratch.path());
    CHECK(run_swage({"check", scene.string(), "--assets", ""}).code == 2);
}

TEST_CASE("a scene is told of no more cells than a mold can have") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1);
    const Outcome told =
        run_swage({"check", scene.string(), "--set", "mold.cell_limit=1000000001"});
    CHECK(told.code == 3);
    CHECK(says(told.err, "it must be 1 to 1000000000"));
}

TEST_CASE("blanks about the sign of an override are none of its value") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    const Outcome outcome = run_swage({"check", scene.string(), "--set", "material.name = copper",
                                       "--set", "stage.1.angle = 5 deg "});
    INFO(outcome.err);
    CHECK(outcome.code == 0);
}

TEST_CASE("a run that is asked to stop prints its record") {
    const Scratch scratch;
    const fs::path scene =
        put_small_scene(scratch.path(), 5000, "[output]\nmeshes_per_frame = true\n");
    const fs::path run = scratch.path() / "run";
    RunningSwage running({"run", scene.string(), "--json", "--out", run.string()}, scratch.path());
    for (int n = 0; n < 3000 && !fs::exists(run / "meshes/1-bend/frame_0003.obj"); ++n) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    running.signal(SIGINT);
    const Outcome outcome = running.wait();
    INFO(outcome.err);
    CHECK(outcome.code == 128 + SIGINT);
    REQUIRE_FALSE(outcome.out.empty());
    const Json told = parse_json(outcome.out);
    CHECK(told.at("state") == "interrupted");
    CHECK(told == parse_json(bytes_of(run / "run.json")));
}

TEST_CASE("what a command has of its own commands' options is not said to be every command's") {
    CHECK_FALSE(says(run_swage({"make", "--help"}).out, "Options of every command"));
    const std::string bar = run_swage({"make", "bar", "--help"}).out;
    CHECK(says(bar, "Options of every command"));
    CHECK(says(bar, "--threads"));
    CHECK(says(run_swage({"keys", "retry_limit"}).out, "in motion only, not energy-stepped"));
}

TEST_CASE("a record that says no way to draw is refused") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1), out = scratch.path() / "run";
    REQUIRE(run(scene, out).code == 0);
    const Json whole = parse_json(bytes_of(out / "run.json"));
    const auto drawn_with = [&](const char* key, const Json& value) {
        Json record = whole;
        record["render"][key] = value;
        put_text(out / "run.json", json_text(record));
        return run_swage({"render", out.string(), "--no-film"});
    };
    for (const Json& angle : {Json(0), Json(-1), Json(3.2)}) {
        const Outcome outcome = drawn_with("field_of_view", angle);
        INFO(outcome.err);
        CHECK(outcome.code == 5);
        CHECK(says(outcome.err, "run.json"));
    }
    CHECK(drawn_with("size", {0, 90}).code == 5);
    CHECK_FALSE(fs::exists(out / "again/frames/frame_0001.png"));
}

TEST_CASE("a record tells how its bodies were molded, dressed and placed") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1), out = scratch.path() / "run";
    put_text(scene, bytes_of(scene) +
                        "[skin]\ncrease_angle = \"1 rad\"\n[[body]]\nname = \"other\"\n"
                        "file = \"bar.obj\"\nspacing = \"1 cm\"\nat = [0, \"50 cm\", 0]\n"
                        "turn = [0, 2, 0]\nvelocity = [3, 0, 0]\nspin = [0, 0, 4]\n");
    std::string text = bytes_of(scene);
    text.replace(text.find("frames = 1"), 10, "frames = 1\nduration = \"1 us\"");
    text.replace(text.find("angle = \"10 deg\""), 16, "angle = \"0.001 deg\"");
    put_text(scene, text);
    const Outcome ran = run(scene, out);
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    const Json record = parse_json(bytes_of(out / "run.json"));
    const Json &bar = record.at("bodies").at(0), &other = record.at("bodies").at(1);
    CHECK(bar.at("mold") == Json({{"kind", "shape"}, {"cell_limit", 50'000'000}, {"across", 2}}));
    CHECK(other.at("mold").at("spacing_m") == 0.01);
    CHECK_FALSE(other.at("mold").contains("across"));
    CHECK(bar.at("start").at("at_m") == nullptr);
    CHECK(other.at("start") == Json({{"at_m", {0, 0.5, 0}},
                                     {"turn_rad", {0, 2, 0}},
                                     {"velocity_m_s", {3, 0, 0}},
                                     {"spin_rad_s", {0, 0, 4}}}));
    CHECK(record.at("skin") ==
          Json({{"kind", "mount"}, {"divide", 1.5}, {"crease_angle_rad", 1}, {"roughness", 0.25}}));
}
