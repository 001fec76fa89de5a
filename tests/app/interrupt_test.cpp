// SPDX-License-Identifier: GPL-3.0-or-later
#include <signal.h>

#include <chrono>
#include <fstream>
#include <map>
#include <string>
#include <thread>

#include "base/process.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

namespace {

void nap(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

bool wait_for(const fs::path& file, RunningSwage& run) {
    for (int n = 0; n < 3000 && run.is_running(); ++n) {
        if (fs::exists(file)) return true;
        nap(10);
    }
    return fs::exists(file);
}

void check_only_whole_files(const fs::path& run) {
    if (!fs::exists(run)) return;  // it had not begun
    for (const auto& entry : fs::recursive_directory_iterator(run)) {
        INFO(entry.path().string());
        CHECK(entry.path().filename().string().find(".part") == std::string::npos);
        CHECK(entry.path().filename() != ".swage-lock");
        if (entry.path().extension() == ".png") {
            const std::string bytes = bytes_of(entry.path());
            CHECK(bytes.compare(bytes.size() - 8, 4, "IEND") == 0);
        }
    }
}

// Puts a gnuplot that never ends into the folder; `first`: what it does before.
std::map<std::string, std::string> hanging_gnuplot(const fs::path& folder,
                                                   const std::string& first) {
    const fs::path gnuplot = folder / "gnuplot";
    put_text(gnuplot, "#!/bin/sh\n" + first + "\nsleep 1000 & wait\n");
    fs::permissions(gnuplot, fs::perms::owner_all);
    return {{"PATH", folder.string() + ":" + std::getenv("PATH")}};
}

}  // namespace

TEST_CASE("a run that is asked to stop leaves only whole files within two seconds", "[stress]") {
    const int signal = GENERATE(SIGTERM, SIGINT, SIGHUP);
    const bool while_drawing = GENERATE(false, true);
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 200);
    const fs::path run = scratch.path() / "run";
    RunningSwage running({"run", scene.string(), "--out", run.string(), "--json"}, scratch.path());
    const fs::path sign = while_drawing ? run / "frames/frame_0003.png" : run / ".swage-run";
    REQUIRE(wait_for(sign, running));
    const auto asked = Clock::now();
    running.signal(signal);
    const Outcome outcome = running.wait();
    INFO(outcome.err);
    CHECK(std::chrono::duration<double>(Clock::now() - asked).count() < 2.5);
    CHECK(outcome.code == 128 + signal);
    if (while_drawing) {
        REQUIRE(fs::exists(run));
        CHECK(parse_json(outcome.out) == parse_json(bytes_of(run / "run.json")));
    }
    check_only_whole_files(run);
    CHECK_FALSE(fs::exists(run / "film.mp4"));
}

TEST_CASE("a stopped run that is asked to stop as it draws says why it had stopped") {
    const Scratch scratch;
    const fs::path run = scratch.path() / "run";
    const fs::path scene =
        put_small_scene(scratch.path(), 200,
                        "[[stage]]\nmachine = \"hold\"\niteration_limit = 100\nframes = 1\n"
                        "[[stage.load]]\non = \"right\"\nforce = [0, \"-20 kN\", 0]\n");
    RunningSwage running({"run", scene.string(), "--out", run.string(), "--json"}, scratch.path());
    REQUIRE(wait_for(run / "frames/frame_0003.png", running));
    running.signal(SIGTERM);
    const Outcome outcome = running.wait();
    INFO(outcome.err);
    CHECK(outcome.code == 6);
    CHECK(parse_json(outcome.out).at("state") == "stopped");
    CHECK(parse_json(outcome.out).contains("stopped"));
    check_only_whole_files(run);
}

TEST_CASE("frames that were finished before a run was asked to stop can be drawn") {
    // Of a terminal that closes shell and kernel both tell.
    const int signal = GENERATE(SIGINT, SIGHUP);
    const Scratch scratch;
    const fs::path scene =
        put_small_scene(scratch.path(), 5000, "[output]\nmeshes_per_frame = true\n");
    const fs::path run = scratch.path() / "run";
    RunningSwage running({"run", scene.string(), "--out", run.string()}, scratch.path());
    REQUIRE(wait_for(run / "meshes/1-bend/frame_0004.obj", running));
    running.signal(signal);
    if (signal == SIGHUP) running.signal(signal);
    const Outcome outcome = running.wait();
    INFO(outcome.err);
    CHECK(outcome.code == 128 + signal);
    CHECK(outcome.err.find("frames are finished") != std::string::npos);
    check_only_whole_files(run);
    const Json record = parse_json(bytes_of(run / "run.json"));
    CHECK(record["state"] == "interrupted");
    CHECK(record["frames"] >= 4);
    CHECK(record["frames"] < 5001);
    CHECK(fs::exists(run / "curves/1-bend.csv"));
    const fs::path drawn = scratch.path() / "drawn";
    const Outcome render =
        run_swage({"render", run.string(), "--frames", "3-4", "--out", drawn.string()});
    INFO(render.err);
    CHECK(render.code == 0);
    CHECK(fs::exists(drawn / "frames/frame_0004.png"));
}

TEST_CASE("finished frames are kept though a plot hangs, which ends with the run") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(
        scratch.path(), 3, "[[stage]]\nmachine = \"bend\"\nangle = \"10 deg\"\nframes = 3\n");
    const fs::path run = scratch.path() / "run";
    RunningSwage running({"run", scene.string(), "--out", run.string()}, scratch.path(),
                         hanging_gnuplot(scratch.path(), "echo $$ > pid; mv pid plotting"));
    REQUIRE(wait_for(scratch.path() / "plotting", running));
    running.signal(SIGINT);
    const Outcome outcome = running.wait();
    INFO(outcome.err);
    CHECK(outcome.code == 128 + SIGINT);
    check_only_whole_files(run);
    REQUIRE(fs::exists(run / "run.json"));
    const Json record = parse_json(bytes_of(run / "run.json"));
    CHECK(record["state"] == "interrupted");
    CHECK(record["frames"] == 4);  // those of the first stage, and none of the second
    const Outcome render = run_swage({"render", run.string(), "--frames", "4"});
    INFO(render.err);
    CHECK(render.code == 0);
    // Whoever is left of it may still be waited for by nobody.
    const int group = std::stoi(bytes_of(scratch.path() / "plotting"));
    for (int n = 0; n < 500 && ::kill(-group, 0) == 0; ++n) nap(10);
    CHECK(::kill(-group, 0) != 0);
    CHECK_FALSE(fs::exists(run / "curves/1-bend.svg"));
    if (!swage::program_exists("gnuplot")) return;
    CHECK(run_swage({"run", scene.string(), "--out", run.string()}).code == 0);
    CHECK(fs::exists(run / "curves/1-bend.svg"));
}

TEST_CASE("a run that is asked to stop while its last plot is drawn is not done") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    const fs::path run = scratch.path() / "run";
    RunningSwage running({"run", scene.string(), "--no-render", "--out", run.string()},
                         scratch.path(), hanging_gnuplot(scratch.path(), "touch plotting"));
    REQUIRE(wait_for(scratch.path() / "plotting", running));
    running.signal(SIGINT);
    const Outcome outcome = running.wait();
    INFO(outcome.err);
    CHECK(outcome.code == 128 + SIGINT);
    check_only_whole_files(run);
    REQUIRE(fs::exists(run / "run.json"));
    CHECK(parse_json(bytes_of(run / "run.json"))["state"] == "simulated");
    if (!swage::program_exists("gnuplot")) return;
    CHECK(run_swage({"run", scene.string(), "--no-render", "--out", run.string()}).code == 0);
    CHECK(fs::exists(run / "curves/1-bend.svg"));
}

TEST_CASE("who asks a run to end by two signals at a time, as timeout does, asks once") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 2000);
    const fs::path run = scratch.path() / "run";
    RunningSwage running({"run", scene.string(), "--no-render", "--out", run.string()},
                         scratch.path());
    REQUIRE(wait_for(run / "curves", running));
    nap(300);
    for (int n = 0; n < 3; ++n) {
        running.signal(SIGTERM);
        nap(5);
    }
    const Outcome outcome = running.wait();
    INFO(outcome.err);
    CHECK(outcome.code == 128 + SIGTERM);
    REQUIRE(fs::exists(run / "run.json"));
    CHECK(parse_json(bytes_of(run / "run.json"))["state"] == "interrupted");
    CHECK(fs::exists(run / "motion.bin"));
}

namespace {

// One that takes some time to read.
void put_long_mesh(const fs::path& mesh) {
    std::string text;
    for (int n = 0; n < 500'000; ++n) {
        text += "v " + std::to_string(n) + " " + std::to_string(n % 7) + " 0\n";
    }
    for (int n = 1; n + 2 <= 500'000; ++n) {
        text += "f " + std::to_string(n) + " " + std::to_string(n + 1) + " " +
                std::to_string(n + 2) + "\n";
    }
    put_text(mesh, text);
}

// Sends it while a mesh is read, as a terminal does: to the process and to what it has started.
Outcome end_as_it_reads(int signal, RunningSwage& running) {
    const std::string pid = std::to_string(running.pid());
    const fs::path children = fs::path("/proc") / pid / "task" / pid / "children";
    std::string child;
    for (int n = 0; n < 500 && child.empty() && running.is_running(); ++n) {
        nap(2);
        std::ifstream(children) >> child;
    }
    running.signal(signal);
    if (!child.empty()) ::kill(std::stoi(child), signal);
    return running.wait();
}

}  // namespace

TEST_CASE("who asks a program to end while it reads a mesh is not told that the file is damaged") {
    const int signal = GENERATE(SIGINT, SIGTERM);
    const Scratch scratch;
    const fs::path mesh = scratch.path() / "long.obj";
    put_long_mesh(mesh);
    RunningSwage running({"info", mesh.string()}, scratch.path());
    const Outcome outcome = end_as_it_reads(signal, running);
    INFO(outcome.err);
    CHECK(outcome.code == 128 + signal);
    CHECK(outcome.err.find("damaged") == std::string::npos);
}

TEST_CASE("who asks for JSON is told in it that a run was asked to end as it read its mesh") {
    const std::string command = GENERATE("run", "check");
    const Scratch scratch;
    put_long_mesh(scratch.path() / "long.obj");
    const fs::path scene = scratch.path() / "long.toml";
    put_text(scene,
             "[mesh]\nfile = \"long.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 2\n"
             "[[stage]]\nmachine = \"bend\"\n");
    RunningSwage running({command, scene.string(), "--json"}, scratch.path());
    const Outcome outcome = end_as_it_reads(SIGTERM, running);
    INFO(outcome.err << outcome.out);
    CHECK(outcome.code == 128 + SIGTERM);
    const Json told = parse_json(outcome.out);
    CHECK(told.at("file") == scene.string());
    REQUIRE(told.at("mistakes").size() == 1);
    CHECK(says(told.at("mistakes").at(0).at("text"), "interrupted"));
    CHECK_FALSE(fs::exists(scratch.path() / "renders"));
}

TEST_CASE("a second run in the same directory is refused while the first goes on") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 200);
    const fs::path run = scratch.path() / "run";
    RunningSwage running({"run", scene.string(), "--out", run.string()}, scratch.path());
    REQUIRE(wait_for(run / ".swage-run", running));
    const Outcome second = run_swage({"run", scene.string(), "--out", run.string()});
    CHECK(second.code == 8);
    CHECK(second.err.find(std::to_string(running.pid())) != std::string::npos);
}

TEST_CASE("after a run was killed the next one does all of it") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 40);
    const fs::path run = scratch.path() / "run";
    {
        RunningSwage running({"run", scene.string(), "--out", run.string()}, scratch.path());
        REQUIRE(wait_for(run / ".swage-run", running));
        nap(150);
        running.signal(SIGKILL);
        CHECK(running.wait().code == 128 + SIGKILL);
    }
    nap(700);  // a film program that has lost its reader writes what it has
    const Outcome again =
        run_swage({"run", scene.string(), "--out", run.string(), "--frames", "1-2"});
    INFO(again.err);
    CHECK(again.code == 0);
    check_only_whole_files(run);
}
