// SPDX-License-Identifier: GPL-3.0-or-later
// Stages of motion that follow one another in the middle of what happens.
#include "tests/app/resumed_run.h"
#include "tests/shared/scratch.h"

using namespace resumed;

namespace {

// Two cubes fly at each other, above a floor that they do not come to.
const std::string kStrike =
    "[mesh]\nfile = \"cube.obj\"\nturn = [0, 0, \"10 deg\"]\n"
    "[material]\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.3\ndensity = \"1000 kg/m3\"\n"
    "damping_ratio = 0.03\nfriction = 0.4\nrestitution = 0.5\n[mold]\nacross = 4\n"
    "[[body]]\nname = \"other\"\nfile = \"cube.obj\"\nat = [\"1.3 cm\", \"3.4 cm\", \"1 cm\"]\n"
    "velocity = [0, \"-4 m/s\", 0]\n";

// Times that rounding leaves as they are, where frames are a power of two.
std::string fly(int frames, const std::string& more = "") {
    return fmt::format(
        "[[stage]]\nmachine = \"floor\"\ndrop = \"1 m\"\nframes = {}\nduration = \"{:.12f} s\"\n{}",
        frames, frames / 4096.0, more);
}

Json record_of(const fs::path& scene, const std::string& stages) {
    const fs::path out = scene.parent_path() / "run";
    fs::remove_all(out);
    put_text(scene, kStrike + stages);
    const Outcome outcome = run(scene, out);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return parse_json(bytes_of(out / "run.json"));
}

}  // namespace

TEST_CASE("motion in several stages leaves bodies that strike each other as one stage does") {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), "");
    const Json whole = record_of(scene, fly(16));
    const std::vector<std::vector<int>> parts = {{8, 8}, {4, 4, 8}, {8, 4, 4}};
    for (const std::vector<int>& frames : parts) {
        std::string stages;
        for (const int count : frames) stages += fly(count);
        CHECK(record_of(scene, stages).at("state_hash") == whole.at("state_hash"));
    }
    // What is molded anew in between has nothing on its surface that it was.
    CHECK(record_of(scene, fly(8) + fly(8, "remold = true\n")).at("state_hash") !=
          whole.at("state_hash"));
}
