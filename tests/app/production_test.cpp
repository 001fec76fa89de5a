// SPDX-License-Identifier: GPL-3.0-or-later
// Frame rates, numbers and cameras as film productions want them.
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"
#include "tests/shared/usda.h"

namespace fs = std::filesystem;

namespace {

Json record_of(const fs::path& run) { return parse_json(bytes_of(run / "run.json")); }

}  // namespace

TEST_CASE("a run at 23.976 from frame 1001 on is so in names, film, times and USD") {
    const Scratch scratch;
    const fs::path run = scratch.path() / "run", out = scratch.path() / "out";
    const fs::path scene = put_small_scene(scratch.path(), 3,
                                           "fps = 23.976\nfirst_frame = 1001\n"
                                           "passes = [\"matte\", \"motion\"]\n"
                                           "[output]\nmeshes_per_frame = true\n");
    const Outcome outcome = run_swage({"run", scene.string(), "--out", run.string()});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    for (const char* name : {"frame_1001.png", "frame_1004.png", "frame_1002.matte.png",
                             "frame_1004.motion.exr", "mattes.json"}) {
        CHECK(fs::exists(run / "frames" / name));
    }
    CHECK_FALSE(fs::exists(run / "frames/frame_0001.png"));
    CHECK_FALSE(fs::exists(run / "frames/frame_1005.png"));
    CHECK(fs::exists(run / "meshes/1-bend/frame_1001.obj"));
    CHECK(fs::exists(run / "meshes/1-bend/frame_1004.ply"));
    const Json record = record_of(run);
    CHECK(record.at("render").at("first_frame") == 1001);
    CHECK(record.at("render").at("frame_rate") == Json{24000, 1001});
    CHECK(record.at("stages").at(0).at("duration_s").get<double>() == 3 / (24000 / 1001.0));
    CHECK(run_swage({"run", scene.string(), "--out", run.string()}).err.find("already complete") !=
          std::string::npos);
    if (fs::exists(run / "film.mp4")) {
        const std::string told = scratch.path() / "rate";
        const std::string command =
            "ffprobe -v error -select_streams v -show_entries stream=r_frame_rate,avg_frame_rate "
            "-of csv=p=0 " +
            (run / "film.mp4").string() + " > " + told;
        if (std::system(command.c_str()) == 0) {
            CHECK(bytes_of(told) == "24000/1001,24000/1001\n");
        }
    }
    REQUIRE(run_swage({"export", run.string(), "--frames", "1002-"}).code == 0);
    const Usda usda(bytes_of(run / "usd/small.usda"));
    CHECK(usda.text(".startTimeCode") == "1002");
    CHECK(usda.text(".endTimeCode") == "1004");
    CHECK(std::strtod(usda.text(".timeCodesPerSecond").c_str(), nullptr) == 24000 / 1001.0);
    CHECK_FALSE(usda.numbers("/small/work_piece.points", 1003).empty());

    // Drawn again as the scene says, or as is asked.
    const auto draw = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"render", run.string(), "--no-film", "--out", out.string()});
        return run_swage(more);
    };
    CHECK(draw({"--frames", "1003-"}).code == 0);
    CHECK(fs::exists(out / "frames/frame_1003.png"));
    CHECK_FALSE(fs::exists(out / "frames/frame_1002.png"));
    const Outcome beyond = draw({"--frames", "3"});
    CHECK(beyond.code == 2);
    CHECK(beyond.err.find("--frames 3 is out of range: the run has the frames 1001 to 1004") !=
          std::string::npos);
    CHECK(draw({"--frames", "3", "--first-frame", "1"}).code == 0);
    CHECK(fs::exists(out / "frames/frame_0003.png"));
    CHECK_FALSE(fs::exists(out / "frames/frame_1003.png"));
    CHECK(draw({"--first-frame", "0"}).code == 2);
    CHECK(draw({"--fps", "23.9"}).code == 2);
    CHECK(draw({"--frames", "1", "--first-frame", "1", "--fps", "30000/1001"}).code == 0);
}

TEST_CASE("a run whose scene says nothing of numbers has none of them in run.json") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1), run = scratch.path() / "run";
    REQUIRE(run_swage({"run", scene.string(), "--out", run.string(), "--no-render"}).code == 0);
    const Json render = record_of(run).at("render");
    CHECK(json_text(render.at("frames_per_second")) == "30\n");
    CHECK_FALSE(render.contains("frame_rate"));
    CHECK_FALSE(render.contains("first_frame"));
}

TEST_CASE("an export has the camera and lamp of a drawing with the same options") {
    const Scratch scratch;
    const fs::path one = scratch.path() / "one", other = scratch.path() / "other";
    const auto exported = [&](const fs::path& folder, const std::string& scene_more,
                              std::vector<std::string> more) {
        fs::create_directories(folder);
        const fs::path scene = put_small_scene(folder, 3, scene_more), run = folder / "run";
        REQUIRE(run_swage({"run", scene.string(), "--out", run.string(), "--no-render"}).code == 0);
        more.insert(more.begin(), {"export", run.string()});
        const Outcome outcome = run_swage(more);
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        return bytes_of(run / "usd/small.usda");
    };
    const std::string asked =
        exported(one, "",
                 {"--camera-azimuth", "90", "--camera-elevation", "10", "--camera-zoom", "1.5",
                  "--field-of-view", "20", "--light-azimuth", "30"});
    CHECK(asked == exported(other,
                            "field_of_view = \"20 deg\"\n[render.camera]\nazimuth = \"90 deg\"\n"
                            "elevation = \"10 deg\"\nzoom = 1.5\n[render.light]\n"
                            "azimuth = \"30 deg\"\n",
                            {}));
    const auto line_of = [](const std::string& text, const std::string& key) {
        const std::size_t at = text.find(key);
        REQUIRE(at != std::string::npos);
        return text.substr(at, text.find('\n', at) - at);
    };
    // A picture as high as this one is wide sees so much more upward.
    const fs::path run = one / "run";
    REQUIRE(run_swage({"export", run.string(), "--size", "90x160"}).code == 0);
    const std::string upright = bytes_of(run / "usd/small.usda");
    CHECK(line_of(upright, "verticalAperture") != line_of(asked, "verticalAperture"));
    const fs::path third = scratch.path() / "third";
    const std::string follow = "[render.camera]\nfollow = true\n",
                      follows = exported(third, follow, {});
    CHECK(exported(one, "", {"--camera-follow"}) == follows);
    const std::string stays = exported(one, "", {});
    CHECK(exported(third, follow, {"--no-camera-follow"}) == stays);
    CHECK(stays != follows);
    CHECK(run_swage({"export", run.string(), "--camera-eye", "1", "1", "1"}).code == 2);
    CHECK(run_swage({"export", run.string(), "--camera-elevation", "91"}).code == 2);
}
