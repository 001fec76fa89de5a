// SPDX-License-Identifier: GPL-3.0-or-later
// What a run says of a stage that did not do what was meant.
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/pipeline/scratch.h"


namespace fs = std::filesystem;

namespace {

// What a run of a bar in these stages says.
std::string told_of(const std::string& stages) {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml";
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, scratch.path());
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = "
             "2\n" +
                 stages);
    const Outcome outcome = run_swage(
        {"run", scene.string(), "--out", (scratch.path() / "run").string(), "--no-render"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return outcome.err;
}

bool says(const std::string& text, const std::string& what) {
    return text.find(what) != std::string::npos;
}

}  // namespace

TEST_CASE("a blade that meets nothing is told of, and one that cuts is not") {
    CHECK(says(told_of("[[stage]]\nmachine = \"cut\"\nframes = 2\nplace = 2\n"),
               "has met no matter"));
    CHECK(!says(told_of("[[stage]]\nmachine = \"cut\"\nframes = 2\n"), "met no matter"));
}

TEST_CASE(
    "what a cut has laid open takes no pressure, and the run says so until it is molded anew") {
    const std::string cut = "[[stage]]\nmachine = \"cut\"\nframes = 2\n",
                      hold = "[[stage]]\nmachine = \"hold\"\nframes = 1\n",
                      press = "[[stage.load]]\npressure = \"1 kPa\"\n";
    const std::string warning = "does not act on faces";
    CHECK(!says(told_of(hold + press), warning));
    CHECK(says(told_of(cut + hold + press), warning));
    CHECK(!says(told_of(cut + hold + "remold = true\n" + press), warning));
}
