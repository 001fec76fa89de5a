// SPDX-License-Identifier: GPL-3.0-or-later
// What the program answers where it is asked otherwise than usual.
#include <sys/wait.h>

#include <cstdlib>

#include "pipeline/json.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/pipeline/scratch.h"

namespace fs = std::filesystem;
using swage::Json;

namespace {

// Through a shell, in that folder: "swage" in it is the program.
Outcome in_shell(const std::string& command, const fs::path& folder) {
    const std::string line = "cd '" + folder.string() + "' && export SWAGE_ASSETS='" +
                             SWAGE_SOURCE_DIR + "'; swage() { '" + SWAGE_BINARY +
                             "' \"$@\"; }; ( " + command + " ) >out 2>err";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, bytes_of(folder / "out"),
            bytes_of(folder / "err")};
}

}  // namespace

TEST_CASE("run tells what keeps it from running as JSON, as check does") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 3, "fsp = 3\n");
    const auto both = [&](std::vector<std::string> more) {
        std::vector<std::string> run = {"run", scene.string(), "--json", "--out",
                                        (scratch.path() / "run").string()};
        std::vector<std::string> check = {"check", scene.string(), "--json"};
        run.insert(run.end(), more.begin(), more.end());
        check.insert(check.end(), more.begin(), more.end());
        const Outcome ran = run_swage(run), checked = run_swage(check);
        INFO(ran.out << ran.err);
        CHECK(ran.code == checked.code);
        CHECK(ran.code != 0);
        const Json told = Json::parse(ran.out), wanted = Json::parse(checked.out);
        CHECK(told.at("mistakes") == wanted.at("mistakes"));
        CHECK(told.at("file") == wanted.at("file"));
        CHECK_FALSE(told.at("mistakes").empty());
    };
    both({});
    put_small_scene(scratch.path(), 3);
    both({"--set", "stage.1.radius=2 m"});  // which only the mesh shows
    both({"--set", "mesh.file=none.obj"});
    both({"--set", "mold.cell_limit=3"});  // which its mold goes beyond
}

TEST_CASE("data for a stdout that is closed ends with 5, and what has none is done") {
    const Scratch scratch;
    for (const char* command : {"swage keys >&-", "swage --version >&-", "swage help >&-"}) {
        INFO(command);
        const Outcome closed = in_shell(command, scratch.path());
        CHECK(closed.code == 5);
        CHECK(closed.err.find("standard output: cannot be written") != std::string::npos);
    }
    const fs::path scene = put_small_scene(scratch.path(), 1);
    const Outcome run =
        in_shell("swage run " + scene.string() + " --no-render --out run >&- <&-", scratch.path());
    CHECK(run.code == 0);
    CHECK(in_shell("swage keys 2>&-", scratch.path()).code == 0);
}

TEST_CASE("check tells how fast the film plays what takes its time") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1, "fps = 25\n");
    const auto told = [&] { return run_swage({"check", scene.string()}).out; };
    CHECK(told().find("film ") == std::string::npos);
    const std::string still = bytes_of(scene);
    const auto with_fall = [&](const std::string& duration) {
        put_text(scene, still +
                            "[[stage]]\nname = \"fall\"\nmachine = \"floor\"\n"
                            "gravity = 9.81\nframes = 5\nduration = \"" +
                            duration + "\"\n");
        return told();
    };
    CHECK(with_fall("50 ms").find(
              "film         fall: 5 frames at 25 fps show its 50 ms 4 times slower than real "
              "time\n") != std::string::npos);
    CHECK(with_fall("200 ms").find("its 200 ms in real time\n") != std::string::npos);
    CHECK(with_fall("0.4 s").find("2 times faster than real time\n") != std::string::npos);
}

TEST_CASE("a scene is read from standard input, its paths from the working directory") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1);
    const std::string name = scene.filename().string();
    const Outcome checked = in_shell("swage check - <" + name, scratch.path());
    INFO(checked.err);
    CHECK(checked.code == 0);
    CHECK(checked.out.find("stdin: no mistakes\n") == 0);
    const auto run = [&](const std::string& from, const std::string& more) {
        return in_shell("swage run " + from + " --no-render --out run" + more, scratch.path());
    };
    REQUIRE(run("-", " <" + name).code == 0);
    const Json piped = Json::parse(bytes_of(scratch.path() / "run/run.json"));
    CHECK(piped.at("scene") == "stdin");
    // It is the same run as that of the file, and another once the scene is another.
    CHECK(run(name, "").err.find("already complete") != std::string::npos);
    put_text(scene, bytes_of(scene) + "# more\n");
    CHECK(run("-", " <" + name).err.find("already complete") != std::string::npos);
    CHECK(run("- --set material.density=1234", " <" + name).code == 8);
    const Outcome wrong = in_shell("echo 'masch = 3' | swage check -", scratch.path());
    CHECK(wrong.code == 3);
    CHECK(wrong.err.find("stdin:1:1: unknown key \"masch\"") != std::string::npos);
    CHECK(in_shell("swage check - <&-", scratch.path()).err.find("scene is empty") !=
          std::string::npos);
    CHECK(in_shell("swage check - </", scratch.path())
              .err.find("stdin: standard input cannot be read: ") != std::string::npos);
}
