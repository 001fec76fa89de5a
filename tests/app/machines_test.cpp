// SPDX-License-Identifier: GPL-3.0-or-later
#include <sstream>

#include "base/text.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

TEST_CASE("a machine's parameters are told with the unit of a number that has none") {
    const Scratch scratch;
    std::string text = "help = \"tries\"\n";
    for (const char* quantity : {"number", "force", "angle", "stress", "drag", "toughness"}) {
        text += std::string("[parameter.its_") + quantity + "]\nquantity = \"" + quantity +
                "\"\ndefault = 3\n";
    }
    put_text(scratch.path() / "mine.toml",
             text + "[[grip]]\nname = \"a\"\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n");
    const Outcome table = run_swage({"machines", "mine.toml"}, scratch.path());
    REQUIRE(table.code == 0);
    const Json json =
        parse_json(run_swage({"machines", "mine.toml", "--json"}, scratch.path()).out);
    for (const Json& parameter : json.at("parameters")) {
        const auto name = parameter.at("name").get<std::string>();
        const auto unit = parameter.at("unit").get<std::string>();
        INFO(table.out << name);
        std::istringstream rest(table.out.substr(table.out.find("  " + name + " ")));
        std::string shown;
        rest >> shown >> std::ws;
        std::getline(rest, shown);
        const auto quantity = parameter.at("quantity").get<std::string>();
        CHECK(shown == quantity + (unit.empty() ? "" : " [" + unit + "]") + "; default 3");
    }
}

TEST_CASE("who asks for one machine is not told of the files of others") {
    const Scratch scratch;
    const std::string grip = "[[grip]]\nname = \"a\"\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n";
    fs::create_directories(scratch.path() / "machines");
    put_text(scratch.path() / "machines" / "mine.toml", "help = \"tries\"\n" + grip);
    put_text(scratch.path() / "machines" / "other.toml",
             "help = \"tries\"\n[parameter.idle]\nquantity = \"number\"\ndefault = 3\n" + grip);
    const Outcome mine = run_swage({"machines", "mine"}, scratch.path());
    CHECK(mine.code == 0);
    CHECK(mine.err.empty());
    const std::string idle = "no expression uses the parameter \"idle\"";
    CHECK(says(run_swage({"machines", "other"}, scratch.path()).err, idle));
    CHECK(says(run_swage({"machines"}, scratch.path()).err, idle));
}

TEST_CASE("a machine is told in lines that fit, but for where its file is") {
    for (const char* name :
         {"bend", "cut", "floor", "hold", "press", "shelf", "slice", "stretch", "twist", "wring"}) {
        for (const std::string& line : swage::lines_of(run_swage({"machines", name}).out)) {
            if (line.ends_with(".toml")) continue;
            INFO(line);
            CHECK(line.size() <= 100);
        }
    }
}

TEST_CASE("a machine whose file is faulty is told to be that, not to be missing") {
    const Scratch scratch;
    fs::create_directory(scratch.path() / "machines");
    const std::string grip = "[[grip]]\nname = \"a\"\nfrom = [0, 0, 0]\nto = [1, 1, \"";
    put_text(scratch.path() / "machines/bad.toml", grip + "heigth\"]\n");
    put_text(scratch.path() / "machines/bad2.toml", grip + "height\"]\n");
    const Outcome bad = run_swage({"machines", "bad"}, scratch.path());
    INFO(bad.err);
    CHECK(bad.code == 3);
    CHECK(bad.err.find("unknown name \"heigth\"") != std::string::npos);
    CHECK(bad.err.find("bad.toml does not make a usable machine") != std::string::npos);
    CHECK(bad.err.find("bad2") == std::string::npos);
    CHECK(run_swage({"machines", "bad2"}, scratch.path()).code == 0);
    CHECK(run_swage({"machines"}, scratch.path()).code == 0);  // tells the others
    CHECK(run_swage({"machines", "badd"}, scratch.path()).code == 2);
}

TEST_CASE(
    "the program alone, without its assets, tells all keys, and where it looked for machines") {
    const Scratch scratch;
    const fs::path alone = scratch.path() / "swage";
    fs::copy_file(SWAGE_BINARY, alone);
    const auto told = [&](const std::vector<std::string>& words) {
        return run_swage(words, scratch.path(), {{"SWAGE_ASSETS", ""}}, alone);
    };
    CHECK(told({"keys"}).out == run_swage({"keys"}).out);
    CHECK(told({"keys", "pressure"}).code == 0);
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"machines"}, {"machines", "--json"}, {"machines", "bend"}}) {
        const Outcome none = told(words);
        INFO(none.err);
        CHECK(none.code == 2);
        CHECK(none.out.empty());
        CHECK(none.err.find((scratch.path() / "machines").string()) != std::string::npos);
    }
    fs::create_directory(scratch.path() / "machines");
    fs::copy_file(fs::path(SWAGE_SOURCE_DIR) / "machines/bend.toml",
                  scratch.path() / "machines/mine.toml");
    CHECK(told({"machines"}).out.find("mine") != std::string::npos);
    const Outcome other = told({"machines", "bend"});
    CHECK(other.code == 2);
    CHECK(other.err.find("known: mine; looked in " + (scratch.path() / "machines").string()) !=
          std::string::npos);
}

TEST_CASE("who names the folder assets itself is told to name the one above") {
    const Scratch scratch;
    const fs::path alone = scratch.path() / "bin/swage", shelf = scratch.path() / "shelf";
    fs::create_directories(alone.parent_path());
    fs::copy_file(SWAGE_BINARY, alone);
    fs::create_directories(shelf / "assets");
    fs::copy(fs::path(SWAGE_SOURCE_DIR) / "machines", shelf / "machines");
    fs::copy_file(fs::path(SWAGE_SOURCE_DIR) / "assets/materials.toml",
                  shelf / "assets/materials.toml");
    const fs::path scene = put_small_scene(alone.parent_path());
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"machines"}, {"machines", "bend"}, {"check", scene.string()}}) {
        const auto told = [&](const fs::path& assets) {
            return run_swage(words, scratch.path(), {{"SWAGE_ASSETS", assets.string()}}, alone);
        };
        const Outcome wrong = told(shelf / "assets");
        INFO(wrong.err);
        CHECK(wrong.code != 0);
        CHECK(wrong.err.find("set SWAGE_ASSETS (or --assets) to " + fs::canonical(shelf).string() +
                             ", which") != std::string::npos);
        CHECK(told(shelf).code == 0);
    }
}
