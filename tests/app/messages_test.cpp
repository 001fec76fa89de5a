// SPDX-License-Identifier: GPL-3.0-or-later
// What the program answers where it is asked otherwise than usual.
#include <sys/wait.h>

#include <cstdlib>

#include <fmt/format.h>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

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
        const Json told = parse_json(ran.out), wanted = parse_json(checked.out);
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
    const Json piped = parse_json(bytes_of(scratch.path() / "run/run.json"));
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

TEST_CASE("what is missing is called as the usage calls it, and what is mistyped as what it is") {
    const std::pair<const char*, const char*> missing[] = {{"run", "SCENE"},
                                                           {"check", "SCENE"},
                                                           {"info", "MESH|RUN"},
                                                           {"render", "RUN"},
                                                           {"export", "RUN"}};
    for (const auto& [command, argument] : missing) {
        const Outcome outcome = run_swage({command});
        CHECK(outcome.code == 2);
        CHECK(outcome.err.find(
                  fmt::format("error: {1} is required: swage {0} {1}\n", command, argument)) == 0);
    }
    CHECK(run_swage({"make", "barr"})
              .err.find("error: there is no shape \"barr\", did you mean \"bar\"?\n") == 0);
    CHECK(run_swage({"materials", "coppr"})
              .err.find("\"coppr\", did you mean \"copper\"? The command swage materials") !=
          std::string::npos);
    for (const char* range : {"abc", "1e999", "3x", ""}) {
        const Outcome outcome = run_swage({"render", "somewhere", "--color-range", "0", range});
        CHECK(outcome.code == 2);
        CHECK(outcome.err.find(fmt::format("error: --color-range: \"{}\" is not a finite number\n",
                                           range)) == 0);
    }
}

TEST_CASE("a key is told with its section before it, as --set has it") {
    const auto keys = [](const std::string& word) { return run_swage({"keys", word}); };
    const Outcome color = keys("render.color");
    CHECK(color.code == 0);
    CHECK(color.out.find("[render]\n  color  ") == 0);
    CHECK(color.out.find("[mesh]") == std::string::npos);
    CHECK(keys("render.camera").out.find("azimuth") != std::string::npos);
    CHECK(keys("stage.2.frames").out.find("[[stage]]\n  frames  ") == 0);
    CHECK(keys("stage.1.load.1.force").out.find("[[stage.load]]\n  force  ") == 0);
    CHECK(keys("material.yield_stress").code == 0);
    const Outcome none = keys("stage.1.angle");
    CHECK(none.code == 2);
    CHECK(none.err.find("swage machines NAME lists those of a machine") != std::string::npos);
    CHECK(keys("render.colr").code == 2);
    const auto says = [](const Outcome& outcome, const std::string& what) {
        INFO(outcome.err);
        return outcome.code == 2 && outcome.err.find(what) != std::string::npos;
    };
    CHECK(says(keys("render.colour"), ", did you mean \"render.color\"?"));
    CHECK(says(keys("stage.1.framse"), ", did you mean \"stage.frames\"? The command swage"));
    CHECK(says(keys("repeat"), "in scenes; swage keys --machine lists those of machine files"));
    const auto of_machine = [](const std::string& word) {
        return run_swage({"keys", "--machine", word});
    };
    CHECK(says(of_machine("repeet"), ", did you mean \"repeat\"?"));
    CHECK(says(of_machine("tool.repeet"), ", did you mean \"tool.repeat\"?"));
    CHECK(says(of_machine("frames"), "in machine files; swage keys lists those of scenes"));
    CHECK(keys("units").out.find("kip") != std::string::npos);
}

TEST_CASE("an override of a list, or one that a shell has split, is told how to be written") {
    const Scratch scratch;
    const std::string scene = put_small_scene(scratch.path(), 1).string();
    const auto told = [&](const std::vector<std::string>& set) {
        std::vector<std::string> words = {"check", scene, "--set"};
        words.insert(words.end(), set.begin(), set.end());
        return run_swage(words).err;
    };
    CHECK(told({"render.passes=depth, motion"})
              .find("passes must be a list of texts, such as [\"depth\", \"motion\"]") !=
          std::string::npos);
    CHECK(told({"render.passes=deep"}).find("such as [\"depth\"]") != std::string::npos);
    CHECK(told({"render.passes=depth,", "motion"})
              .find("--set motion: write an override as KEY=VALUE, such as stage.1.angle=45 deg; "
                    "one with blanks needs quotes in a shell: --set 'KEY=VALUE'") !=
          std::string::npos);
}

TEST_CASE("what is not there ends with the code of what it would be") {
    const Scratch scratch;
    const std::string scene = put_small_scene(scratch.path(), 1).string(),
                      none = (scratch.path() / "none").string();
    fs::create_directory(scratch.path() / "empty");
    const auto code = [&](const std::vector<std::string>& words) {
        return run_swage(words, scratch.path()).code;
    };
    for (const char* command : {"run", "check"}) {
        CHECK(code({command, none + ".toml"}) == 3);
        CHECK(code({command, scene, "--set", "stage.1.machine=none.toml"}) == 3);
        CHECK(code({command, scene, "--set", "stage.1.machine=none"}) == 3);
        CHECK(code({command, scene, "--set", "mesh.file=none.obj"}) == 4);
    }
    CHECK(code({"machines", none + ".toml"}) == 3);
    CHECK(code({"info", none + ".obj"}) == 4);
    for (const char* command : {"render", "export"}) CHECK(code({command, none}) == 5);
    for (const char* command : {"render", "export", "info"}) CHECK(code({command, "empty"}) == 5);
    for (const char* command : {"machines", "materials", "keys", "make", "verify", "help"}) {
        CHECK(code({command, "none"}) == 2);
    }
}

TEST_CASE("info repeats what a run warned of") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1), run = scratch.path() / "run";
    const auto info = [&] { return run_swage({"info", run.string()}).out; };
    REQUIRE(run_swage({"run", scene.string(), "--no-render", "--out", run.string()}).code == 0);
    Json record = parse_json(bytes_of(run / "run.json"));
    record["warnings"] = {"1-bend: it slipped", "2-cut: it missed"};
    put_text(run / "run.json", json_text(record));
    CHECK(info().find("  warning      1-bend: it slipped\n  warning      2-cut: it missed\n") !=
          std::string::npos);
    // Those of what it plotted and drew too.
    record["plots"]["warnings"] = {"no gnuplot"};
    record["drawing"] = {{"warnings", {"no film"}}};
    put_text(run / "run.json", json_text(record));
    CHECK(info().find("  warning      no gnuplot\n  warning      no film\n") !=
          std::string::npos);
    record["warnings"] = 3;
    put_text(run / "run.json", json_text(record));
    CHECK(run_swage({"info", run.string()}).code == 5);
}

TEST_CASE("what a scene says in vain is on the record of its run, and in what that prints") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1), run = scratch.path() / "run";
    put_text(scene, bytes_of(scene) + "[skin]\nroughness = 0.1\n");  // rubber does not break
    const Outcome ran =
        run_swage({"run", scene.string(), "--no-render", "--json", "--out", run.string()});
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    REQUIRE(ran.err.find("has no effect") != std::string::npos);
    for (const Json& record : {parse_json(bytes_of(run / "run.json")), parse_json(ran.out)}) {
        REQUIRE(record.at("warnings").size() >= 1);
        const std::string first = record.at("warnings").at(0);
        CHECK(first.find("small.toml:") != std::string::npos);
        CHECK(first.find("has no effect") != std::string::npos);
        CHECK(ran.err.find(first.substr(first.find("roughness"))) != std::string::npos);
    }
    CHECK(run_swage({"info", run.string()}).out.find("has no effect") != std::string::npos);
}

TEST_CASE("who asks for more is told what each frame took the solver") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    const auto told = [&](const char* how, const char* run) {
        const Outcome outcome = run_swage(
            {"run", how, scene.string(), "--no-render", "--out", (scratch.path() / run).string()});
        INFO(outcome.err);
        CHECK(outcome.code == 0);
        return outcome.err;
    };
    const std::string much = told("--verbose", "much");
    const Json stage = parse_json(bytes_of(scratch.path() / "much/run.json")).at("stages").at(0);
    long iterations = 0;
    for (int frame = 2; frame <= 4; ++frame) {
        const std::string start = fmt::format("bend, frame {}: ", frame);
        const std::size_t at = much.find(start);
        REQUIRE(at != std::string::npos);
        iterations += std::stol(much.substr(at + start.size()));
    }
    CHECK(iterations == stage.at("iterations").get<long>());
    CHECK(told("--threads=1", "usual").find("frame 2: ") == std::string::npos);
}
