// SPDX-License-Identifier: GPL-3.0-or-later
// What `swage check` foretells of stages, and what a run then keeps of that.
#include "geometry/box_mesh.h"
#include "geometry/mesh_write.h"
#include "pipeline/json.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/pipeline/scratch.h"

namespace fs = std::filesystem;
using swage::Json;

namespace {

// A bar of 20 cm x 2 cm x 2 cm in these stages; `keys` stand in [mesh].
struct Bar {
    explicit Bar(const std::string& stages, const std::string& material = "rubber",
                 const std::string& keys = {}) {
        swage::write_obj(scratch.path() / "bar.obj",
                         swage::box_mesh({-0.1, -0.01, -0.01}, {0.1, 0.01, 0.01}));
        put_text(scene, "[mesh]\nfile = \"bar.obj\"\n" + keys + "[material]\nname = \"" + material +
                            "\"\n[mold]\nacross = 2\n" + stages);
    }
    Outcome check() const { return run_swage({"check", scene.string()}); }
    Json json() const { return Json::parse(run_swage({"check", scene.string(), "--json"}).out); }
    Outcome run() const {
        return run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    }
    Json record() const { return Json::parse(bytes_of(out / "run.json")); }

    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", out = scratch.path() / "run";
};

std::size_t count_of(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
        ++count;
    }
    return count;
}
bool says(const std::string& text, const std::string& what) { return count_of(text, what) > 0; }

// All that check says.
std::string told_of(const Bar& bar) {
    const Outcome check = bar.check();
    CHECK(check.code == 0);
    return check.err + check.out;
}

const std::string kStretch = "[[stage]]\nmachine = \"stretch\"\nframes = 2\nstrain = ";

}  // namespace

TEST_CASE("a later stage that could not be set up at the body as molded is warned of") {
    const Bar bar(
        kStretch +
        "0.2\n[[stage]]\nmachine = \"hold\"\nframes = 1\n[[stage.load]]\n"
        "force = [0, \"-2 N\", 0]\non = \"top\"\nfrom = [\"20 cm\", \"-1 cm\", \"-1 cm\"]\n"
        "to = [\"30 cm\", \"1 cm\", \"1 cm\"]\n");
    const std::string told = told_of(bar);
    INFO(told);
    CHECK(count_of(told, "load load_1 acts on nothing: ") == 1);
    CHECK(says(told, "(stage \"2-hold\", for the work-piece before the first stage)"));
    CHECK(says(bar.json().at("cost").at("warnings").dump(), "load_1 acts on nothing"));
    const Outcome run = bar.run();
    CHECK(run.code == 3);
    CHECK(says(bar.record().at("warnings").dump(), "load_1 acts on nothing"));
}

TEST_CASE("what a run has disproved of the warnings of its start is not in its record") {
    const Bar bar(kStretch +
                  "1.5\n[[stage]]\nmachine = \"bend\"\nangle = \"20 deg\"\n"
                  "overhang = \"21 cm\"\nframes = 2\n");
    CHECK(says(told_of(bar), "overhang = 21 cm is out of range"));
    const Outcome run = bar.run();
    INFO(run.err);
    REQUIRE(run.code == 0);
    CHECK(says(run.err, "overhang = 21 cm is out of range"));
    CHECK(!says(bar.record().at("warnings").dump(), "out of range"));
}
