// SPDX-License-Identifier: GPL-3.0-or-later
// What one command says, another or a file of the run says too.
#include "geometry/box_mesh.h"
#include "geometry/mesh_write.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

namespace {

// A bar of 20 cm x 2 cm x 2 cm and what else is given.
struct BarOf {
    explicit BarOf(const std::string& rest) {
        swage::write_obj(scratch.path() / "bar.obj",
                         swage::box_mesh({-0.1, -0.01, -0.01}, {0.1, 0.01, 0.01}));
        put_text(scene, "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n" + rest);
    }
    Outcome run(const std::string& command) const {
        std::vector<std::string> words = {command, scene.string()};
        if (command == "run") {
            words.insert(words.end(), {"--no-render", "--out", out.string()});
        }
        return run_swage(words);
    }

    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", out = scratch.path() / "run";
};

}  // namespace

// By sizes alone, it takes steps all the way; that it flies is known of the matter.
TEST_CASE("check tells of a run that is refused before its matter is made") {
    const BarOf bar(
        "[mold]\nacross = 6\n[[stage]]\nmachine = \"floor\"\ndrop = \"100 m\"\n"
        "gravity = 1e-12\nduration = \"1e7 s\"\nframes = 1\n");
    const Outcome run = bar.run("run"), check = bar.run("check");
    INFO(check.out << check.err);
    CHECK(run.code == 7);
    CHECK(says(run.err, "the run would take at least "));
    CHECK(check.code == run.code);
    CHECK(says(check.err, "the run would take at least "));
    CHECK(says(check.out, "but it cannot run here"));
}

TEST_CASE("a run's record tells how gravity comes on, and where insets are") {
    const BarOf bar(
        "[mold]\nacross = 2\n[[inset]]\nfrom = [0, 0, 0]\nto = [0.5, 1, 1]\nname = \"copper\"\n"
        "[[inset]]\nfile = \"bar.obj\"\nname = \"glass\"\nstrength = \"inf\"\n"
        "[[stage]]\nmachine = \"hold\"\ngravity = 9.81\ngravity_strength = \"ramp(t, 0, 0.5)\"\n"
        "frames = 1\n[[stage]]\nmachine = \"hold\"\ngravity = 9.81\nframes = 1\n");
    const Outcome run = bar.run("run");
    INFO(run.err);
    REQUIRE(run.code == 0);
    const Json record = parse_json(bytes_of(bar.out / "run.json"));
    CHECK(record.at("stages")[0].at("gravity_strength") == "ramp(t, 0, 0.5)");
    CHECK(record.at("stages")[1].at("gravity_strength").is_null());
    const Json insets = record.at("bodies")[0].at("insets");
    REQUIRE(insets.size() == 2);
    CHECK(insets[0].at("from") == Json::array({0.0, 0.0, 0.0}));
    CHECK(insets[0].at("to") == Json::array({0.5, 1.0, 1.0}));
    CHECK(insets[1].at("file") == (bar.scratch.path() / "bar.obj").string());
}

TEST_CASE("a made mesh has no picture beside it but the one that it names") {
    const Scratch scratch;
    REQUIRE(run_swage({"make", "calf", "--out", "a b.obj"}, scratch.path()).code == 0);
    int pictures = 0;
    for (const auto& entry : fs::directory_iterator(scratch.path())) {
        pictures += entry.path().extension() == ".png";
    }
    CHECK(pictures == 1);
    CHECK(says(bytes_of(scratch.path() / "a_b.mtl"), "a_b.png"));
    CHECK(fs::exists(scratch.path() / "a_b.png"));
}
