// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that cannot begin, or end early: what is left of them.
#include <sys/resource.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

TEST_CASE("a stage that cannot begin leaves what those before it have done") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(
        scratch.path(), 3, "[[stage]]\nmachine = \"twist\"\nangle = \"5 deg\"\nremold = true\n");
    const fs::path run = scratch.path() / "run";
    // Bent for good, it takes a larger box.
    const Outcome outcome =
        run_swage({"run", scene.string(), "--out", run.string(), "--set", "mold.cell_limit=60",
                   "--set", "material.name=lead", "--set", "stage.1.angle=60 deg"});
    INFO(outcome.err);
    CHECK(outcome.code == 7);
    REQUIRE(fs::exists(run / "run.json"));
    CHECK(parse_json(bytes_of(run / "run.json")).at("frames") == 4);
    CHECK(is_whole_png(bytes_of(run / "frames/frame_0004.png")));
    CHECK(run_swage({"render", run.string(), "--no-film"}).code == 0);
}

TEST_CASE("where one of the bodies cannot be molded anew, all stay as they were") {
    const Scratch scratch;
    put_small_scene(scratch.path());  // its mesh
    const fs::path scene = scratch.path() / "two.toml", run = scratch.path() / "run";
    const std::string stage = "[[stage]]\nmachine = \"floor\"\nframes = 1\nduration = \"1 ms\"\n";
    // The other stands aslant, and so has a larger box then.
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 2\n"
             "cell_limit = 100\n[[body]]\nname = \"other\"\nfile = \"bar.obj\"\n"
             "at = [0, \"20 cm\", 0]\nturn = [0, 0, \"45 deg\"]\n" +
                 stage + stage + "remold = true\n");
    const Outcome outcome =
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render"});
    INFO(outcome.err);
    CHECK(outcome.code == 7);
    const Json record = parse_json(bytes_of(run / "run.json"));
    CHECK(record.at("state_hash") == record.at("stages").at(0).at("state_hash"));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they run without the limit
TEST_CASE("a run that wants for memory on its way keeps the frames that it has finished") {
    const Scratch scratch;
    const fs::path scene =
        put_small_scene(scratch.path(), 3, "[[stage]]\nmachine = \"bend\"\nframes = 100000000\n");
    const fs::path run = scratch.path() / "run";
    rlimit before = {};
    ::getrlimit(RLIMIT_AS, &before);
    const rlimit limit = {rlim_t(600) << 20, before.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_AS, &limit) == 0);
    const Outcome outcome = run_swage(
        {"run", scene.string(), "--out", run.string(), "--no-render", "--force", "--threads", "2"});
    ::setrlimit(RLIMIT_AS, &before);
    INFO(outcome.err);
    CHECK(outcome.code == 7);
    CHECK(outcome.err.find("not enough memory; a larger [mold] spacing needs less") !=
          std::string::npos);
    REQUIRE(fs::exists(run / "run.json"));
    const Json record = parse_json(bytes_of(run / "run.json"));
    CHECK(record.at("state") == "stopped");
    CHECK(record.at("frames") == 4);
    CHECK(run_swage({"render", run.string(), "--no-film", "--frames", "4"}).code == 0);
}
#endif

TEST_CASE("a run that cannot be written is refused before it is simulated") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    put_text(scratch.path() / "file", "");
    CHECK(run_swage({"run", scene.string(), "--out", (scratch.path() / "file").string()}).code ==
          5);
    CHECK(run_swage({"run", scene.string(), "--out", (scratch.path() / "file/below").string()})
              .code == 5);
    CHECK(run_swage({"run", scene.string(), "--out", scratch.path().string()}).code == 8);
}

TEST_CASE(
    "a first machine that cannot be set up leaves nothing, and is told where its file has it") {
    const Scratch scratch;
    put_small_scene(scratch.path());  // its mesh
    const fs::path scene = scratch.path() / "odd.toml", run = scratch.path() / "run";
    fs::create_directory(scratch.path() / "machines");
    put_text(scratch.path() / "machines/vice.toml",
             "[[grip]]\nname = \"jaw\"\nfrom = [5, 5, 5]\nto = [6, \"5 + length\", 6]\n");
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 2\n"
             "[[stage]]\nmachine = \"vice\"\ngravity = 1\n");
    for (const char* command : {"check", "run"}) {
        std::vector<std::string> words = {command, scene.string()};
        if (words[0] == "run") words.insert(words.end(), {"--out", run.string(), "--no-render"});
        const Outcome outcome = run_swage(words);
        INFO(outcome.err);
        CHECK(outcome.code == 3);
        CHECK(outcome.err.find("machines/vice.toml:3:9: machine vice: grip jaw holds nothing") !=
              std::string::npos);
        CHECK_FALSE(fs::exists(run));
    }
}

TEST_CASE("a later machine that cannot be set up leaves what was done, and is told at its place") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 2,
                                           "[[stage]]\nmachine = \"bend\"\nframes = 2\n"
                                           "radius = \"1 um\"\n");
    const fs::path run = scratch.path() / "run";
    const Outcome outcome = run_swage({"run", scene.string(), "--out", run.string()});
    INFO(outcome.err);
    CHECK(outcome.code == 3);
    CHECK(outcome.err.find("small.toml:16:10: machine bend: radius = 1 um is out of range") !=
          std::string::npos);
    CHECK(fs::exists(run / "frames/frame_0003.png"));
    const Json record = parse_json(bytes_of(run / "run.json"));
    CHECK(record["state"] == "stopped");
    CHECK(record["frames"] == 3);
}

TEST_CASE(
    "what a machine did of a frame that it gives up is on the books, as it is in the matter") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "twist.toml", run = scratch.path() / "run";
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, scratch.path());
    // An equilibrium every 62 degrees, of which the fifth is not found in so few iterations.
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nyoung_modulus = \"1 MPa\"\n"
             "density = \"1000 kg/m3\"\nyield_stress = \"50 kPa\"\n[mold]\nacross = 2\n"
             "[[stage]]\nmachine = \"twist\"\nangle = \"3600 deg\"\nframes = 1\n"
             "tolerance = 1e-4\niteration_limit = 100\nhalving_limit = 0\n");
    const Outcome outcome =
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render", "--json"});
    INFO(outcome.err);
    REQUIRE(outcome.err.find("1-twist, frame 2: twist: no equilibrium found") != std::string::npos);
    const Json record = parse_json(bytes_of(run / "run.json"));
    CHECK(record.at("frames") == 1);
    CHECK(parse_json(outcome.out) == record);
    const Json& stage = record.at("stages").at(0);
    CHECK(stage.at("state") == "stopped");
    CHECK(stage.at("frames") == Json({2, 1}));  // none is there
    CHECK(stage.at("unfinished_frame") == 2);
    const std::string info = run_swage({"info", run.string()}).out;
    CHECK(says(info, "no frame is finished, and a part of frame 2\n"));
    CHECK(says(info, record.at("stopped").get<std::string>()));
    CHECK(stage.at("increments") > 0);
    CHECK(stage.at("energies_J").at("machine_work") > 0);
    CHECK(bytes_of(run / "curves/1-twist.csv").find("\n2,") != std::string::npos);
}

namespace {

// From the probe "tip" of a row to the nearest vertex of an OBJ.
double tip_off_mesh(std::map<std::string, double> row, const fs::path& file) {
    const std::array place = {row["tip x [m]"], row["tip y [m]"], row["tip z [m]"]};
    std::istringstream lines(bytes_of(file));
    double least = 1e9;
    for (std::string line; std::getline(lines, line);) {
        double x = 0, y = 0, z = 0;
        if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) != 3) continue;
        least = std::min(least, std::hypot(x - place[0], y - place[1], z - place[2]));
    }
    return least;
}

// What is told of a stage that stops.
struct Stopped {
    Outcome outcome;
    Json record, stage;
    std::map<std::string, double> row;  // the last of its table
};
Stopped run_until_stopped(const fs::path& scene, const fs::path& run) {
    Stopped told{
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render"}), {}, {}, {}};
    INFO(told.outcome.err);
    REQUIRE(told.outcome.code == 6);
    told.record = parse_json(bytes_of(run / "run.json"));
    told.stage = told.record.at("stages").back();
    told.row = last_row(run / "curves" / (told.stage.at("name").get<std::string>() + ".csv"));
    return told;
}

constexpr const char* kTip = "[[probe]]\nname = \"tip\"\nat = [1, 1, 1]\n";

}  // namespace

TEST_CASE("of a stage that stops all is told of one time, its first frame too", "[stress]") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", run = scratch.path() / "run";
    run_swage({"make", "bar", "--length", "20 cm", "--out", "bar.obj"}, scratch.path());
    // More than it can bear: in the first frame, in a later one, and before there is any rest.
    const auto& [frames, strength] =
        GENERATE(table<int, std::string>({{1, "t"}, {4, "t"}, {1, "1"}}));
    put_text(scene, std::string("[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"lead\"\n") +
                        "[mold]\nacross = 2\n" + kTip +
                        "[[stage]]\nmachine = \"twist\"\nangle = \"20 deg\"\nframes = 2\n"
                        "[[stage]]\nmachine = \"hold\"\niteration_limit = 500\nframes = " +
                        std::to_string(frames) + "\n[[stage.load]]\non = \"right\"\n" +
                        "force = [0, \"-20 kN\", 0]\nstrength = \"" + strength + "\"\n");
    auto [outcome, record, stage, row] = run_until_stopped(scene, run);
    INFO(outcome.err);
    CHECK(record.at("frames") == stage.at("frames").at(1));
    CHECK(stage.at("unfinished_frame") == record.at("frames").get<int>() + 1);
    CHECK(row["frame"] == stage.at("unfinished_frame").get<int>());
    const bool has_rested = strength == "t";
    const std::string at_rest = fmt::format("at rest at {:.4g} s under {:.6g} kN", row["time [s]"],
                                            -1e-3 * row["load_1 force y [N]"]);
    CHECK(outcome.err.find(at_rest) != std::string::npos);
    CHECK((row["time [s]"] > 0) == has_rested);
    const Json& books = stage.at("energies_J");
    CHECK(books.at("elastic").get<double>() == Approx(row["elastic energy [J]"]));
    CHECK(books.at("elastic").get<double>() > 0);
    CHECK(books.at("elastic_at_start").get<double>() > 0);
    CHECK((books.at("load_work").get<double>() > 0) == has_rested);
    CHECK(stage.at("energies_by_body_J").size() == 1);
    CHECK(stage.at("iterations").get<int>() > 500);
    // Its corner lies where its mesh has it.
    CHECK(tip_off_mesh(row, run / "meshes/2-hold.obj") < 2e-3);
}

TEST_CASE("what a stage did in motion before it stopped is told, of its first frame too") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", run = scratch.path() / "run";
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, scratch.path());
    put_text(scene, std::string("[mesh]\nfile = \"bar.obj\"\nvelocity = [0, \"-60 m/s\", 0]\n") +
                        "[material]\nname = \"glass\"\n[mold]\nacross = 2\n" + kTip +
                        "[[stage]]\nmachine = \"floor\"\ndrop = \"1 cm\"\nduration = \"2 ms\"\n"
                        "gravity = 9.81\nframes = 2\nretry_limit = 0\n");
    auto [outcome, record, stage, row] = run_until_stopped(scene, run);
    INFO(outcome.err);
    CHECK(stage.at("frames") == Json({2, 1}));
    CHECK(stage.at("unfinished_frame") == 2);
    CHECK(row["frame"] == 2);
    CHECK(row["time [s]"] > 0);
    CHECK(stage.at("steps").get<int>() > 0);
    CHECK(stage.at("energies_by_body_J").size() == 1);
    CHECK(stage.at("energies_J").at("kinetic_at_start").get<double>() > 0);
    // It has gone 1 cm down since it began.
    CHECK(tip_off_mesh(row, run / "meshes/1-floor.obj") < 2e-3);
}

TEST_CASE("where steps that energy chooses give up, all bodies are told of one time") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", run = scratch.path() / "run";
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, scratch.path());
    // Two that stick without friction gain energy; another flies apart from them, by itself.
    const bool with_another = GENERATE(false, true);
    const std::string flies = with_another ? "3, 0, 0]\nvelocity = [0, 1, 0" : "0, 0, 0";
    put_text(scene, "[mesh]\nfile = \"bar.obj\"\nat = [" + flies + "]\n" + kTip +
                        "[material]\nyoung_modulus = 1e6\npoisson_ratio = 0.3\n"
                        "density = 1000\nfriction = 0\nstickiness = 50e3\n[mold]\nacross = 1\n"
                        "[[body]]\nfile = \"bar.obj\"\nat = [0.001, 0.011, 0.0005]\n"
                        "velocity = [2, -1, 0]\n" +
                        (with_another ? "[[body]]\nfile = \"bar.obj\"\nat = [0, 0, 0]\n" : "") +
                        "[[stage]]\nmachine = \"floor\"\ndrop = 10\ngravity = 0\nframes = 5\n"
                        "duration = 0.1\nsolver = \"energy-stepped\"\n");
    auto [outcome, record, stage, row] = run_until_stopped(scene, run);
    INFO(outcome.err);
    CHECK(stage.at("unfinished_frame") == static_cast<int>(row["frame"]));
    CHECK(tip_off_mesh(row, run / "meshes/1-floor-work-piece.obj") < 2e-3);
}

TEST_CASE("a fresh run that cannot start leaves the run that was there, one that can replaces it") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 2), run = scratch.path() / "run";
    const auto go = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"run", scene.string(), "--out", run.string(), "--no-render"});
        return run_swage(more).code;
    };
    REQUIRE(go({}) == 0);
    const auto before = files_below(run);
    CHECK(go({"--fresh", "--set", "stage.1.frames=100000000"}) == 7);
    CHECK(files_below(run) == before);
    CHECK(go({"--fresh", "--set", "stage.1.radius=1 um"}) == 3);
    CHECK(files_below(run) == before);
    CHECK(go({"--fresh", "--set", "stage.1.frames=1"}) == 0);
    CHECK(parse_json(bytes_of(run / "run.json")).at("frames") == 2);
}

TEST_CASE("a run that failed before its first frame does not keep the mended one out") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 2), run = scratch.path() / "run";
    const auto go = [&](const char* radius) {
        return run_swage({"run", scene.string(), "--out", run.string(), "--no-render", "--set",
                          std::string("stage.1.radius=") + radius})
            .code;
    };
    CHECK(go("1 um") == 3);
    CHECK(go("2 cm") == 0);
    CHECK(go("3 cm") == 8);
}
