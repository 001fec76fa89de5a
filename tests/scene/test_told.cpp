// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/document.h"
#include "scene/read_scene.h"
#include "tests/catch.h"
#include "tests/scene/scene_folder.h"

using namespace swage;

namespace {

std::string told_of(const std::string& text) {
    const test::SceneFolder scratch;
    const std::filesystem::path file = scratch.write("scene.toml", text);
    MistakeList mistakes;
    const std::optional<Document> document = read_document(file, file, mistakes);
    REQUIRE(document);
    std::string all;
    for (const Said& one : said_in(document->root, {})) all += one.key + "=" + one.value + "\n";
    return all;
}

std::string said_of_scene(const std::string& stage, const std::vector<std::string>& overrides) {
    const test::SceneFolder scratch;
    const SceneReading reading =
        read_scene(scratch.write("scene.toml",
                                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"copper\"\n"
                                 "[[stage]]\nmachine = \"bend\"\n" +
                                     stage),
                   overrides, test::shipped());
    REQUIRE(reading.scene);
    std::string all;
    for (const Said& one : reading.scene->said) all += one.key + "=" + one.value + "\n";
    return all;
}

}  // namespace

TEST_CASE(
    "what a file says is told alike however it is written, and otherwise where it says else") {
    const std::string one = told_of("[a]\nx = 0.1\ny = [1, \"2\"]\nz = true\n[[s]]\nn = 1\n");
    CHECK(told_of("[[s]]\nn = 1\n[a]\nz = true\ny = [1, \"2\"]\nx = 0.1\n[b]\n") == one);
    CHECK(told_of("a = { x = 1e-1, y = [ 1, '2' ], z = true } # so\ns = [{n = 1}]\n") == one);
    for (const char* other : {
             "[a]\nx = 0.10000000000000002\ny = [1, \"2\"]\nz = true\n[[s]]\nn = 1\n",
             "[a]\nx = 0.1\ny = [1, 2]\nz = true\n[[s]]\nn = 1\n",
             "[a]\nx = 0.1\ny = [1, \"2\"]\nz = false\n[[s]]\nn = 1\n",
             "[a]\nx = 0.1\ny = [1, \"2\"]\nz = true\n[[s]]\n[[s]]\nn = 1\n",
             "[a]\nx = 0.1\ny = [1, \"2\"]\nz = true\n[[s]]\nn = 1\n[[s]]\n",
             "[a]\nx = 0.1\ny = [1, \"2\"]\nz = true\n[[s]]\n[s.n]\nm = 1\n",
             "[a]\nx = 0.1\ny = [1, \"2;z\"]\nz = true\n[[s]]\nn = 1\n",
         }) {
        CHECK(told_of(other) != one);
    }
}

TEST_CASE("a quantity says the same in whatever unit, and where else it is set") {
    const std::string one = said_of_scene("radius = \"2 cm\"\nangle = \"90 deg\"\n", {});
    CHECK(said_of_scene("angle = \"0.25 turns\"\nradius = \"20 mm\"\n", {}) == one);
    CHECK(said_of_scene("radius = 0.02\nangle = \"90 deg\"\n", {}) == one);
    CHECK(said_of_scene("", {"stage.1.angle=90 deg", "stage.bend.radius='20 mm'"}) == one);
    CHECK(said_of_scene("radius = \"3 cm\"\n", {"stage.*.radius=5 m", "stage.1.radius=0.02",
                                                "stage.1.angle=90deg"}) == one);
    CHECK(said_of_scene("angle = \"90 deg\"\n", {}) != one);
    CHECK(said_of_scene("radius = \"2 cm\"\nangle = 1.5\n", {}) != one);
}

TEST_CASE("what is said is shown as it stands, and not at length") {
    const test::SceneFolder scratch;
    MistakeList mistakes;
    const std::filesystem::path file =
        scratch.write("scene.toml", "a = \"4 cm\"\nb = [1, 2.5, \"x\"]\nc = true\nd = []\ne = \"" +
                                        std::string(59, 'e') + "\u00e9\u00e9\"\nf = 2e-7\n");
    const std::optional<Document> document = read_document(file, file, mistakes);
    REQUIRE(document);
    std::vector<std::string> shown;
    for (const Said& one : said_in(document->root, {})) shown.push_back(one.shown);
    CHECK(shown == std::vector<std::string>{"4 cm", "[1, 2.5, x]", "true", "[]",
                                            std::string(59, 'e') + "...", "2e-07"});
}
