// SPDX-License-Identifier: GPL-3.0-or-later
// What the program says where it is given too little, or what nobody can use.
#include <sys/resource.h>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they run without the limit
TEST_CASE("where there is no room for threads a run is refused with 7, and nothing is unexpected") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    rlimit before = {};
    ::getrlimit(RLIMIT_AS, &before);
    for (rlim_t mebibytes : {200, 250, 300, 350, 400}) {
        const rlimit limit = {mebibytes << 20, before.rlim_max};
        REQUIRE(::setrlimit(RLIMIT_AS, &limit) == 0);
        const Outcome outcome = run_swage({"check", scene.string(), "--threads", "16"});
        ::setrlimit(RLIMIT_AS, &before);
        INFO(mebibytes << " MiB: " << outcome.err);
        CHECK(outcome.code == 7);
        CHECK_FALSE(says(outcome.err, "unexpected"));
    }
}
#endif

TEST_CASE("a damaged record of a run is refused with 5, and --fresh makes another") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1);
    const fs::path run = scratch.path() / "run", record = run / "run.json";
    const auto again = [&](const std::string& more) {
        return run_swage({"run", scene.string(), "--out", run.string(), "--no-render", more});
    };
    REQUIRE(again("--quiet").code == 0);
    const std::string whole = bytes_of(record);
    const auto damaged = [&](const char* key, const Json& value) {
        Json json = parse_json(whole);
        json[key] = value;
        return swage::json_text(json);
    };
    for (const std::string& text :
         {std::string("{\"state\": \"complete\"}"), damaged("frames", "two"), damaged("frames", 0),
          damaged("frames", 1e18), damaged("seconds", "two"), damaged("plots", 3),
          damaged("stages", nullptr)}) {
        put_text(record, text);
        const Outcome refused = again("--quiet");
        CHECK(refused.code == 5);
        CHECK(says(refused.err, "run.json: is damaged; --fresh throws that run away"));
        CHECK(bytes_of(record) == text);
    }
    CHECK(again("--fresh").code == 0);
    CHECK(parse_json(bytes_of(record)).at("frames") == 2);
}

TEST_CASE("what cannot be a run's folder is told to be that, not to be full") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1);
    const Outcome refused =
        run_swage({"run", scene.string(), "--no-render", "--out", "/proc/none"});
    CHECK(refused.code == 5);
    CHECK_FALSE(says(refused.err, "disk"));
}

TEST_CASE("a run of another build is not taken for this one's, and can be drawn all the same") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1);
    const fs::path run = scratch.path() / "run", mark = run / ".swage-run";
    const auto again = [&](const std::string& more) {
        return run_swage({"run", scene.string(), "--out", run.string(), "--no-render", more});
    };
    REQUIRE(again("--quiet").code == 0);
    CHECK(says(again("--threads=1").err, "already complete"));
    const std::string build = parse_json(bytes_of(run / "run.json")).at("build");
    CHECK(run_swage({"--version"}).out.find(build) != std::string::npos);
    for (const bool is_old : {false, true}) {  // of one that named no build, too
        Json json = parse_json(bytes_of(mark));
        REQUIRE(json.at("build") == build);
        json["build"] = "0123456789ab";
        if (is_old) json.erase("build");
        put_text(mark, swage::json_text(json));
        const Outcome refused = again("--quiet");
        CHECK(refused.code == 8);
        CHECK(says(refused.err, "another build of swage"));
        CHECK(run_swage({"render", run.string(), "--no-film", "--frames", "1"}).code == 0);
        CHECK(again("--fresh").code == 0);
    }
}

TEST_CASE(
    "an empty name is no place to write to, and one that is too long is told with its place") {
    const Scratch scratch;
    const std::string scene = put_small_scene(scratch.path(), 1).string();
    const std::string run = (scratch.path() / "run").string();
    const std::string longer = (scratch.path() / std::string(300, 'x')).string();
    REQUIRE(run_swage({"run", scene, "--out", run, "--no-render"}).code == 0);
    for (const auto& words :
         {std::vector<std::string>{"run", scene, "--no-render"}, {"render", run}}) {
        const auto to = [&](const std::string& out) {
            std::vector<std::string> all = words;
            all.insert(all.end(), {"--out", out});
            return run_swage(all, scratch.path());
        };
        const Outcome nowhere = to("");
        CHECK(nowhere.code == 2);
        CHECK(says(nowhere.err, "--out: \"\" is not a name"));
        const Outcome refused = to(longer);
        CHECK(refused.code == 5);
        CHECK(says(refused.err, longer + ": cannot be created: File name too long"));
    }
    CHECK(run_swage({"make", "bar", "--out", ""}, scratch.path()).code == 2);
    CHECK(run_swage({"verify", "stretch", "--out", ""}, scratch.path()).code == 2);
    CHECK_FALSE(fs::exists(scratch.path() / "renders"));
    CHECK_FALSE(fs::exists(scratch.path() / "run" / "again"));
}

TEST_CASE("whatever is to be named has a name") {
    for (const auto& [command, what] : {std::pair{"run", "scene"},
                                        {"check", "scene"},
                                        {"info", "mesh"},
                                        {"machines", "name"},
                                        {"materials", "name"},
                                        {"keys", "word"},
                                        {"render", "run"},
                                        {"export", "run"},
                                        {"verify", "cases"},
                                        {"help", "command"}}) {
        const Outcome outcome = run_swage({command, ""});
        INFO(command << ": " << outcome.err);
        CHECK(outcome.code == 2);
        CHECK(outcome.out.empty());
        CHECK(says(outcome.err, std::string(what) + ": \"\" is not a name"));
    }
}
