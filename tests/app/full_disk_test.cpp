// SPDX-License-Identifier: GPL-3.0-or-later
// What a run leaves when what it writes finds no room.
#include <algorithm>

#include "tests/app/program.h"
#include "tests/app/small_disk.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

namespace {

// What a shell does with a file system of its own at `full`, of so many kB, which is gone after it.
Outcome in_small_room(const fs::path& folder, int kilobytes, const std::string& commands) {
    fs::create_directories(folder / "full");
    return run_swage(
        {"-rm", "sh", "-c",
         fmt::format("mount -t tmpfs -o size={}k tmpfs full || exit 99\n{}", kilobytes, commands)},
        folder, {{"SWAGE", SWAGE_BINARY}}, "/usr/bin/unshare");
}

}  // namespace

TEST_CASE("what a run has reached is kept and can be drawn when its disk is wholly full") {
    const Scratch scratch;
    if (in_small_room(scratch.path(), 64, "").code != 0) {
        WARN("skipped: nobody but root may mount a file system here");
        return;
    }
    put_small_scene(scratch.path(), 60);
    const std::string run = "\"$SWAGE\" run small.toml --no-render --force --out ";
    REQUIRE(in_small_room(scratch.path(), 64, run + "whole").code == 0);
    const auto frames = int(fs::file_size(scratch.path() / "whole" / "motion.bin") / 1024);
    // However much of its last room meshes and curves would take.
    for (int kilobytes = frames / 2; kilobytes < frames / 2 + 40; kilobytes += 8) {
        const Outcome outcome = in_small_room(
            scratch.path(), kilobytes,
            run +
                "full/run\ncode=$?\nls -A full/run\ncp full/run/run.json record.json\n"
                "\"$SWAGE\" render full/run --no-film --frames 1-2 --out drawn || exit 98\n"
                "exit $code");
        INFO(kilobytes << " kB: " << outcome.out << outcome.err);
        CHECK(outcome.code == 5);
        CHECK(outcome.err.find("motion.bin: cannot be written: No space left") !=
              std::string::npos);
        CHECK(outcome.out.find(".part") == std::string::npos);
        const Json record = parse_json(bytes_of(scratch.path() / "record.json"));
        REQUIRE(record.is_object());
        CHECK(record.at("state") == "stopped");
        CHECK(record.at("frames") > 10);
        CHECK(is_whole_png(bytes_of(scratch.path() / "drawn/frames/frame_0002.png")));
    }
}

TEST_CASE("a stage that the disk is too full for leaves an account of what it did") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 60);
    const fs::path whole = scratch.path() / "whole", run = scratch.path() / "run";
    REQUIRE(run_swage({"run", scene.string(), "--out", whole.string(), "--no-render"}).code == 0);
    const std::uintmax_t room = fs::file_size(whole / "motion.bin") / 2;
    for (const auto& entry : fs::directory_iterator(whole / "meshes"))
        REQUIRE(entry.file_size() < room);
    {
        const SmallDisk disk(room);
        const Outcome outcome = run_swage({"run", scene.string(), "--out", run.string()});
        INFO(outcome.err);
        CHECK(outcome.code == 5);
        CHECK(outcome.err.find("motion.bin: cannot be written: File too large") !=
              std::string::npos);
    }
    const Json record = parse_json(bytes_of(run / "run.json"));
    CHECK(record.at("state") == "stopped");
    const int frames = record.at("frames").get<int>();
    CHECK(frames > 10);
    CHECK(frames < 61);
    CHECK(fs::exists(run / fmt::format("frames/frame_{:04d}.png", frames)));
    // Its books are those of the matter as it was left, a frame after the last that was kept.
    const Json& stage = record.at("stages").at(0);
    CHECK(stage.at("frames").at(1) == frames);
    CHECK(stage.at("unfinished_frame") == frames + 1);
    CHECK(stage.at("state_hash") == record.at("state_hash"));
    const std::string curves = bytes_of(run / "curves/1-bend.csv");
    CHECK(curves.find(fmt::format("\n{},", frames + 1)) != std::string::npos);
    CHECK(curves.find(fmt::format("\n{},", frames + 2)) == std::string::npos);
    CHECK(fs::exists(run / "meshes/1-bend.obj"));
    // Those who come after it may draw it.
    CHECK(run_swage({"render", run.string(), "--no-film", "--frames", "1-2"}).code == 0);
}

TEST_CASE("of a mesh that finds no room nothing is left, what was there before stays") {
    const Scratch scratch;
    const auto make = [&](const char* folder) {
        fs::create_directory(scratch.path() / folder);
        return run_swage({"make", "sphere", "--out", (scratch.path() / folder / "x.obj").string()});
    };
    REQUIRE(make("whole").code == 0);
    const std::uintmax_t room = fs::file_size(scratch.path() / "whole" / "x.obj") - 1;
    const SmallDisk disk(room);
    const Outcome outcome = make("full");
    CHECK(outcome.code == 5);
    CHECK(outcome.err.find("x.obj: cannot be written: File too large") != std::string::npos);
    CHECK(fs::is_empty(scratch.path() / "full"));
    CHECK(make("whole").code == 5);
    for (const char* name : {"x.obj", "x.mtl"}) {
        CHECK(fs::exists(scratch.path() / "whole" / name));
    }
}

TEST_CASE("what stdout has no room for ends with 5, help and version too") {
    for (const auto& words :
         {std::vector<std::string>{"--version"}, {"--help"}, {"run", "--help"}}) {
        CHECK(run_swage(words).code == 0);
        const SmallDisk disk(4);
        CHECK(run_swage(words).code == 5);
    }
}
