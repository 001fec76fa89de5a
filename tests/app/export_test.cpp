// SPDX-License-Identifier: GPL-3.0-or-later
// Runs as one file for animation programs.
#include <signal.h>
#include <sys/resource.h>

#include <sstream>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"
#include "tests/shared/usda.h"

namespace fs = std::filesystem;

namespace {

// Of the lines "v x y z ..." of an OBJ file.
std::vector<float> places_of(const fs::path& file) {
    std::vector<float> places;
    std::istringstream in(bytes_of(file));
    for (std::string line; std::getline(in, line);) {
        if (line.rfind("v ", 0) != 0) continue;
        std::istringstream numbers(line.substr(2));
        double p[3] = {};
        numbers >> p[0] >> p[1] >> p[2];
        for (const double k : p) places.push_back(static_cast<float>(k));
    }
    return places;
}

}  // namespace

TEST_CASE("what a run exports ends as the mesh that it leaves, whatever the language") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path()), run = scratch.path() / "run";
    REQUIRE(run_swage({"run", scene.string(), "--out", run.string(), "--no-render"}).code == 0);
    const Outcome outcome = run_swage({"export", run.string(), "--json"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const fs::path file = run / "usd/small.usda";
    CHECK(parse_json(outcome.out).at("out") == file.string());
    const Usda usd(bytes_of(file));
    CHECK(usd.text(".endTimeCode") == "4");
    const std::vector<float> there = usd.numbers("/small/work_piece.points", 4);
    const std::vector<float> left = places_of(run / "meshes/1-bend.obj");
    REQUIRE(there.size() == left.size());
    for (std::size_t i = 0; i < left.size(); ++i) CHECK(std::abs(there[i] - left[i]) < 1e-7);
    const fs::path other = scratch.path() / "new/other.usda";
    CHECK(run_swage({"export", run.string(), "--out", other.string(), "--threads", "1"},
                    SWAGE_SOURCE_DIR, {{"LC_ALL", "de_DE.UTF-8"}})
              .code == 0);
    CHECK(bytes_of(other) == bytes_of(file));
    // As binary glTF, which an own reader takes for the mesh of its first frame.
    const fs::path glb = scratch.path() / "new/other.glb";
    REQUIRE(run_swage({"export", run.string(), "--no-tools", "--out", glb.string()}).code == 0);
    const Outcome read = run_swage({"info", glb.string(), "--json"});
    const Outcome began = run_swage({"info", (scratch.path() / "bar.obj").string(), "--json"});
    INFO(read.err << began.err);
    CHECK(parse_json(read.out).at("volume_m3").get<double>() ==
          Approx(parse_json(began.out).at("volume_m3").get<double>()).epsilon(1e-6));
    // The run may be thrown away with it.
    CHECK(
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render", "--fresh"}).code ==
        0);
    CHECK_FALSE(fs::exists(file));
}

TEST_CASE("a run that ended early exports the frames that it has") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 2,
                                           "[[stage]]\nmachine = \"bend\"\nframes = 2\n"
                                           "radius = \"1 um\"\n");
    const fs::path run = scratch.path() / "run";
    REQUIRE(run_swage({"run", scene.string(), "--out", run.string(), "--no-render"}).code == 3);
    for (const std::vector<std::string>& which : {std::vector<std::string>{}, {"--frames", "2-"}}) {
        std::vector<std::string> arguments = {"export", run.string()};
        arguments.insert(arguments.end(), which.begin(), which.end());
        CHECK(run_swage(arguments).code == 0);
        const Usda usda(bytes_of(run / "usd/small.usda"));
        CHECK(usda.text(".startTimeCode") == (which.empty() ? "1" : "2"));
        CHECK(usda.text(".endTimeCode") == "3");
    }
}

TEST_CASE("what cannot be exported is told, and leaves what was there as it was") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path()), run = scratch.path() / "run";
    REQUIRE(run_swage({"run", scene.string(), "--out", run.string(), "--no-render"}).code == 0);
    put_text(scratch.path() / "mine.usda", "#usda 1.0\n");
    put_text(scratch.path() / "mine.glb", "glTF");
    fs::create_directory(scratch.path() / "folder.usda");
    const auto before = files_below(scratch.path());
    const auto refused = [&](const fs::path& of, const std::string& out, int code,
                             const std::string& told) {
        const Outcome outcome =
            run_swage({"export", of.string(), "--out", (scratch.path() / out).string()});
        INFO(outcome.err);
        CHECK(outcome.code == code);
        CHECK(outcome.err.find(told) != std::string::npos);
    };
    refused(scratch.path(), "x.usda", 5, "is not a finished run of swage");
    refused(scratch.path() / "none", "x.usda", 5, "no such folder");
    refused(run, "x.abc", 2, "x.abc: the name must end in .usda or .glb");
    refused(run, "mine.usda", 8,
            "mine.usda: was not written by swage export; choose another --out");
    refused(run, "mine.glb", 8, "mine.glb: was not written by swage export; choose another --out");
    refused(run, "folder.usda", 5, "is a folder, not a file");
    CHECK(run_swage({"export", run.string(), "--frames", "2-9"}).code == 2);
    rlimit unlimited{};
    ::getrlimit(RLIMIT_FSIZE, &unlimited);
    const rlimit small = {20'000, unlimited.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
    refused(run, "new/x.usda", 5, "x.usda: cannot be written: File too large");
    refused(run, "new/x.glb", 5, "x.glb: cannot be written: File too large");
    ::setrlimit(RLIMIT_FSIZE, &unlimited);
    CHECK_FALSE(fs::exists(scratch.path() / "new"));
    CHECK_FALSE(fs::exists(run / "usd"));
    CHECK(files_below(scratch.path()) == before);
}
