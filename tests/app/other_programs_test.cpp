// SPDX-License-Identifier: GPL-3.0-or-later
// Plots and films are made by programs that may be absent, slow, or set otherwise by the user.
#include <filesystem>

#include "base/process.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

namespace {

bool holds(const Json& warnings, const std::string& text) {
    for (const Json& one : warnings) {
        if (one.get<std::string>().find(text) != std::string::npos) return true;
    }
    return false;
}

}  // namespace

TEST_CASE("what other programs could not make is on record, and made once they are there") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path()), out = scratch.path() / "out";
    const auto run = [&](const std::map<std::string, std::string>& set) {
        return run_swage({"run", scene.string(), "--out", out.string()}, scratch.path(), set);
    };
    CHECK(run({{"PATH", "/nonexistent"}}).code == 0);
    const Json record = parse_json(bytes_of(out / "run.json"));
    CHECK(holds(record.at("plots").at("warnings"), "gnuplot"));
    CHECK(fs::exists(out / "curves/1-bend.gp"));
    CHECK(holds(record.at("drawing").at("warnings"), "no film"));
    CHECK_FALSE(fs::exists(out / "film.mp4"));

    const Outcome same = run({{"PATH", "/nonexistent"}});
    CHECK(same.err.find("already complete") != std::string::npos);
    if (!program_exists("ffmpeg") || !program_exists("gnuplot")) {
        WARN("the rest skipped: ffmpeg or gnuplot is not installed");
        return;
    }
    CHECK(run({}).code == 0);
    CHECK(fs::exists(out / "film.mp4"));
    CHECK(fs::exists(out / "curves/1-bend.svg"));
    CHECK_FALSE(fs::exists(out / "curves/1-bend.gp"));
    const Json now = parse_json(bytes_of(out / "run.json"));
    CHECK(now.at("drawing").at("warnings").empty());
    CHECK(now.at("plots").at("warnings").empty());
    CHECK(now.at("state") == "complete");
    CHECK(now.at("seconds").at("simulate") == record.at("seconds").at("simulate"));
}

TEST_CASE("a plot does not go by what the user has set for plots") {
    if (!program_exists("gnuplot")) {
        WARN("skipped: gnuplot is not installed");
        return;
    }
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    put_text(scratch.path() / "home/.gnuplot", "set xrange [0:1]\nset title 'mine'\n");
    const auto plot_of = [&](const std::map<std::string, std::string>& set, const char* name) {
        const fs::path out = scratch.path() / name;
        CHECK(run_swage({"run", scene.string(), "--no-render", "--out", out.string()},
                        scratch.path(), set)
                  .code == 0);
        return bytes_of(out / "curves/1-bend.svg");
    };
    CHECK(plot_of({{"HOME", (scratch.path() / "home").string()}}, "a") == plot_of({}, "b"));
}

TEST_CASE(
    "a driver of OpenGL that is not there or crashes is one clear error, before anything is done") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path()), out = scratch.path() / "out";
    const Outcome outcome = run_swage({"run", scene.string(), "--out", out.string()},
                                      scratch.path(), {{"GALLIUM_DRIVER", "swr"}});
    INFO(outcome.err);
    if (outcome.code == 0) {
        WARN("skipped: the driver falls back on another");
        return;
    }
    CHECK(outcome.code == 5);
    CHECK(outcome.err.find("OpenGL") != std::string::npos);
    CHECK_FALSE(fs::exists(out));
}

TEST_CASE("a run whose files are gone or cut short is not complete") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path()), out = scratch.path() / "out";
    const auto run = [&] {
        return run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    };
    CHECK(run().code == 0);
    const std::string motion = bytes_of(out / "motion.bin");
    fs::resize_file(out / "motion.bin", 100);
    const Outcome anew = run();
    CHECK(anew.code == 0);
    CHECK(anew.err.find("begins anew") != std::string::npos);
    CHECK(bytes_of(out / "motion.bin") == motion);
    CHECK(run().err.find("already complete") != std::string::npos);
    // What has all frames is not thrown away for want of a table.
    for (const char* name : {"meshes/1-bend.ply", "curves/1-bend.csv"}) {
        fs::rename(out / name, scratch.path() / "elsewhere");
        const Outcome refused = run();
        CHECK(refused.code == 5);
        CHECK(refused.err.find(std::string(name) + ": is gone") != std::string::npos);
        CHECK(bytes_of(out / "motion.bin") == motion);
        fs::rename(scratch.path() / "elsewhere", out / name);
    }
}
