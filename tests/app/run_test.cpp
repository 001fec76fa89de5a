// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <sstream>

#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

namespace {

// The end of assets/scenes/bar-springback.toml at 3 cells across and 6 frames. To be changed, and
// the reason said in the commit, only when the scene, its mesh, material or machine, the mold or
// the laws and solver are meant to give other numbers.
constexpr const char* kShippedBarHash = "ddf3d364fedf3b81";

// Runs a scene with a bar of 10 cm, bar.obj, into run/.
Outcome run_with_bar(const fs::path& folder, const std::string& text) {
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, folder);
    put_text(folder / "scene.toml", text);
    return run_swage({"run", (folder / "scene.toml").string(), "--out", (folder / "run").string(),
                      "--no-render"});
}

std::string state_hash(const fs::path& run) {
    return parse_json(bytes_of(run / "run.json")).at("state_hash").get<std::string>();
}

}  // namespace

TEST_CASE(
    "a run leaves stills, film, sheet, meshes, curves and its record, and is not done twice") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    const fs::path run = scratch.path() / "run";
    const Outcome first = run_swage({"run", scene.string(), "--out", run.string(), "--json"});
    INFO(first.err);
    REQUIRE(first.code == 0);
    for (const char* name : {"frames/frame_0001.png", "frames/frame_0002.png",
                             "frames/frame_0003.png", "frames/frame_0004.png", "contact.png"}) {
        CHECK(is_whole_png(bytes_of(run / name)));
    }
    CHECK_FALSE(fs::exists(run / "frames/frame_0005.png"));
    for (const char* name : {"meshes/1-bend.obj", "meshes/1-bend.ply", "curves/1-bend.csv"}) {
        CHECK(fs::file_size(run / name) > 100);
    }
    const Json record = parse_json(bytes_of(run / "run.json"));
    CHECK(parse_json(first.out) == record);
    CHECK(record.at("state") == "complete");
    CHECK(record.at("frames") == 4);
    CHECK(record.at("bodies").at(0).at("matter").at("cells") == 40);
    CHECK(record.at("stages").at(0).at("frames") == Json({2, 4}));
    CHECK(record.at("bodies").at(0).at("mesh").at("watertight") == true);
    CHECK(record.at("drawing").at("film").get<bool>() == fs::exists(run / "film.mp4"));
    // Every line of the table: its heading, the start, three frames.
    const std::string table = bytes_of(run / "curves/1-bend.csv");
    CHECK(std::count(table.begin(), table.end(), '\n') == 5);
    const Json& pusher = record.at("stages").at(0).at("peaks").at("left");
    CHECK(pusher.at("force_N").get<double>() > 0);
    CHECK(pusher.at("force_frame") >= 2);
    CHECK(pusher.at("stroke_m").get<double>() > 0);
    CHECK(record.at("bodies").at(0).at("materials").at(0).at("young_modulus_Pa") == 2e6);
    CHECK(record.at("stages").at(0).at("settings").at("tolerance") == 0.01);
    // No temporary, no lock, and no more bytes than were told before.
    std::size_t bytes_there = 0;
    for (const auto& [name, bytes] : files_below(run)) {
        bytes_there += bytes.size();
        CHECK(name.find(".part") == std::string::npos);
        CHECK(name != ".swage-lock");
    }
    const Json told = parse_json(run_swage({"check", scene.string(), "--json"}).out);
    CHECK(told.at("cost").at("disk_bytes").get<std::size_t>() > bytes_there);
    CHECK(told.at("cost").at("disk_bytes").get<std::size_t>() < 2 * bytes_there);

    const auto before = files_below(run);
    const Outcome again = run_swage({"run", scene.string(), "--out", run.string()});
    CHECK(again.code == 0);
    CHECK(again.err.find("already complete") != std::string::npos);
    CHECK(files_below(run) == before);

    // One whose drawing was cut short is then as it would have been without: nothing is drawn.
    const std::string complete = before.at("run.json");
    Json undrawn = parse_json(complete);
    undrawn["state"] = "simulated";
    undrawn.erase("plots");  // what is told last
    put_text(run / "run.json", json_text(undrawn));
    const Outcome not_drawn =
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render"});
    CHECK(not_drawn.code == 0);
    CHECK(not_drawn.err.find("already complete") == std::string::npos);
    CHECK(not_drawn.err.find("already simulated") != std::string::npos);
    const Json ended = parse_json(bytes_of(run / "run.json"));
    CHECK(ended.at("state") == "complete");
    CHECK(ended.at("plots") == parse_json(complete).at("plots"));
    put_text(run / "run.json", complete);

    // Lost pictures come back as they were, without simulating again.
    const std::string still = before.at("frames/frame_0003.png");
    fs::remove(run / "frames/frame_0003.png");
    CHECK(run_swage({"run", scene.string(), "--out", run.string()}).code == 0);
    CHECK(bytes_of(run / "frames/frame_0003.png") == still);

    // Drawn again elsewhere, as the run was and otherwise.
    const fs::path elsewhere = scratch.path() / "elsewhere";
    CHECK(run_swage(
              {"render", run.string(), "--out", elsewhere.string(), "--frames", "3", "--no-film"})
              .code == 0);
    CHECK(bytes_of(elsewhere / "frames/frame_0003.png") == still);
    CHECK_FALSE(fs::exists(elsewhere / "frames/frame_0002.png"));
    CHECK(run_swage({"render", run.string(), "--out", elsewhere.string(), "--frames", "3",
                     "--no-film", "--camera-azimuth", "120"})
              .code == 0);
    CHECK(bytes_of(elsewhere / "frames/frame_0003.png") != still);
    const std::string turned = bytes_of(elsewhere / "frames/frame_0003.png");
    CHECK(run_swage({"render", run.string(), "--out", elsewhere.string(), "--frames", "3",
                     "--no-film", "--camera-eye", "-0.5", "0.2", "0.4", "--camera-target", "0",
                     "-0.01", "0"})
              .code == 0);
    CHECK(bytes_of(elsewhere / "frames/frame_0003.png") != turned);
    const std::string upright = bytes_of(elsewhere / "frames/frame_0003.png");
    CHECK(run_swage({"render", run.string(), "--out", elsewhere.string(), "--frames", "3",
                     "--no-film", "--camera-eye", "-0.5", "0.2", "0.4", "--camera-target", "0",
                     "-0.01", "0", "--camera-up", "z"})
              .code == 0);
    CHECK(bytes_of(elsewhere / "frames/frame_0003.png") != upright);
    CHECK(run_swage({"render", run.string(), "--out", elsewhere.string(), "--frames", "9"}).code ==
          2);
    CHECK(run_swage({"render", run.string(), "--out", run.string()}).code == 8);

    // Another scene does not get in; made fresh, it does.
    const Outcome other = run_swage({"run", scene.string(), "--out", run.string(), "--no-render",
                                     "--set", "stage.1.angle=5 deg"});
    CHECK(other.code == 8);
    CHECK(other.err.find("stage.1.angle is 5 deg now, ") != std::string::npos);
    CHECK(run_swage({"run", scene.string(), "--out", run.string(), "--no-render", "--fresh",
                     "--set", "stage.1.angle=5 deg"})
              .code == 0);
    CHECK_FALSE(fs::exists(run / "frames"));
    CHECK(state_hash(run) != record.at("state_hash").get<std::string>());
}

TEST_CASE("the option --frames draws only these stills, and more can be drawn later") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    const fs::path run = scratch.path() / "run";
    const std::vector<std::string> base = {"run", scene.string(), "--out", run.string()};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), base.begin(), base.end());
        return run_swage(more);
    };
    CHECK(with({"--frames", "2-3"}).code == 0);
    CHECK_FALSE(fs::exists(run / "frames/frame_0001.png"));
    CHECK(fs::exists(run / "frames/frame_0002.png"));
    CHECK(fs::exists(run / "frames/frame_0003.png"));
    CHECK_FALSE(fs::exists(run / "frames/frame_0004.png"));
    const std::string still = bytes_of(run / "frames/frame_0003.png");
    CHECK(with({"--frames", "5"}).code == 2);
    const Outcome all = with({});
    CHECK(all.code == 0);
    CHECK(all.err.find("already simulated") != std::string::npos);
    CHECK(fs::exists(run / "frames/frame_0004.png"));
    CHECK(bytes_of(run / "frames/frame_0003.png") == still);
}

TEST_CASE("the state is the same to the bit at any number of threads") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    std::vector<std::string> hashes;
    std::vector<std::string> meshes;
    for (const char* threads : {"1", "2", "3", "8"}) {
        const fs::path run = scratch.path() / (std::string("run") + threads);
        const Outcome outcome = run_swage(
            {"run", scene.string(), "--out", run.string(), "--no-render", "--threads", threads});
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        hashes.push_back(state_hash(run));
        meshes.push_back(bytes_of(run / "meshes/1-bend.ply"));
    }
    CHECK(std::count(hashes.begin(), hashes.end(), hashes[0]) == 4);
    CHECK(std::count(meshes.begin(), meshes.end(), meshes[0]) == 4);
}

TEST_CASE("a shipped scene ends in the state that it always ended in, at any number of threads") {
    const Scratch scratch;
    for (const char* threads : {"1", "2", "3", "8"}) {
        const fs::path run = scratch.path() / (std::string("run") + threads);
        const Outcome outcome = run_swage({"run", "assets/scenes/bar-springback.toml", "--out",
                                           run.string(), "--no-render", "--threads", threads,
                                           "--set", "mold.across=3", "--set", "stage.1.frames=6"});
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        CHECK(state_hash(run) == kShippedBarHash);
    }
}

TEST_CASE("drawn again, a run has no pictures of another time beside the new ones") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path()), run = scratch.path() / "run";
    REQUIRE(run_swage({"run", scene.string(), "--out", run.string(), "--no-render"}).code == 0);
    REQUIRE(run_swage({"render", run.string(), "--no-film"}).code == 0);
    REQUIRE(fs::exists(run / "again/frames/frame_0004.png"));
    put_text(run / "again/notes.txt", "mine");
    REQUIRE(run_swage({"render", run.string(), "--no-film", "--frames", "1-2"}).code == 0);
    CHECK(fs::exists(run / "again/frames/frame_0002.png"));
    CHECK_FALSE(fs::exists(run / "again/frames/frame_0004.png"));
    CHECK(fs::exists(run / "again/notes.txt"));
}

TEST_CASE("the books of each stage close by what run.json says of it") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(
        scratch.path(), 2, "[[stage]]\nmachine = \"bend\"\nangle = \"20 deg\"\nframes = 2\n");
    const Outcome outcome =
        run_swage({"run", scene.string(), "--no-render", "--json", "--set", "material.name=lead"},
                  scratch.path());
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const Json stages = parse_json(outcome.out).at("stages");
    CHECK(stages.at(1).at("energies_J").at("elastic_at_start") > 0);
    for (const Json& stage : stages) {
        CHECK(stage.at("state") == "complete");
        const auto sum = [&](std::initializer_list<const char*> names) {
            double all = 0;
            for (const char* name : names) all += stage.at("energies_J").at(name).get<double>();
            return all;
        };
        const double begun = sum({"kinetic_at_start", "elastic_at_start", "contact_at_start"}),
                     in = sum({"machine_work", "load_work", "gravity_work"}),
                     out = sum({"kinetic", "elastic", "contact", "plastic", "damped", "friction",
                                "drag", "severed", "fracture", "set_free", "remainder"});
        CHECK(in > 0);
        CHECK(out - begun == Approx(in).epsilon(1e-9));
    }
}

TEST_CASE("how often a run is looked at does not change what its machine does") {
    const Scratch scratch;
    run_swage({"make", "bar", "--length", "10 cm", "--out", (scratch.path() / "bar.obj").string()},
              scratch.path());
    const auto twisted = [&](int frames) {
        const fs::path scene = scratch.path() / "twist.toml",
                       run = scratch.path() / std::to_string(frames);
        put_text(scene,
                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
                 "[mold]\nacross = 2\n[[stage]]\nmachine = \"twist\"\n"
                 "angle = \"480 deg\"\nframes = " +
                     std::to_string(frames) + "\n");
        const Outcome outcome =
            run_swage({"run", scene.string(), "--out", run.string(), "--no-render"});
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        return parse_json(bytes_of(run / "run.json")).at("stages").at(0).at("energies_J");
    };
    // It leaves the straight on the way, by as soft a motion as there is: however it comes there.
    // The later it does, the more it leaps, and the more work is lost in that: the remainder.
    const Json often = twisted(24), seldom = twisted(2);
    const auto kept = [](const Json& books) {
        return books.at("machine_work").get<double>() - books.at("remainder").get<double>();
    };
    CHECK(kept(often) > 1);
    CHECK(kept(seldom) == Approx(kept(often)).epsilon(1e-3));
    CHECK(seldom.at("elastic").get<double>() ==
          Approx(often.at("elastic").get<double>()).epsilon(1e-4));
}

TEST_CASE("the option --set goes over what the scene says") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    const fs::path run = scratch.path() / "run";
    const Outcome outcome =
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render", "--set",
                   "mold.across=3", "--set", "stage.1.frames=2", "--json", "--quiet"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const Json record = parse_json(outcome.out);
    CHECK(record.at("bodies").at(0).at("matter").at("cells") == 135);
    CHECK(record.at("frames") == 3);
    CHECK(record.at("overrides").size() == 2);
}

TEST_CASE("meshes are written for every frame when the scene asks for it") {
    const Scratch scratch;
    const fs::path scene =
        put_small_scene(scratch.path(), 2, "[output]\nmeshes_per_frame = true\n");
    const fs::path run = scratch.path() / "run";
    const Outcome outcome =
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(fs::exists(run / "meshes/1-bend/frame_0001.obj"));
    CHECK(fs::exists(run / "meshes/1-bend/frame_0002.obj"));
    CHECK(bytes_of(run / "meshes/1-bend/frame_0003.ply") == bytes_of(run / "meshes/1-bend.ply"));
}

TEST_CASE("the skin of clay pressed to a quarter of its height keeps the volume", "[stress]") {
    const Scratch scratch;
    const fs::path run = scratch.path() / "run";
    const fs::path scene = fs::path(SWAGE_SOURCE_DIR) / "assets/scenes/clay-press.toml";
    const Outcome outcome =
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const double rest = signed_volume(swage::read_mesh(scene.parent_path() / "../meshes/ball.obj"));
    CHECK(signed_volume(swage::read_mesh(run / "meshes/1-press.obj")) ==
          Approx(rest).epsilon(.003));
}

TEST_CASE("a stage whose steps have damped what they move by themselves says so") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "spin.toml";
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, scratch.path());
    const auto told = [&](const std::string& solver) {
        put_text(scene,
                 "[mesh]\nfile = \"bar.obj\"\nspin = [0, 0, \"60 rad/s\"]\n"
                 "[material]\nname = \"silicone\"\n[mold]\nacross = 2\n"
                 "[[stage]]\nmachine = \"floor\"\ndrop = \"20 cm\"\nframes = 3\n"
                 "duration = \"0.1 s\"\nsolver = \"" +
                     solver + "\"\n");
        const fs::path run = scratch.path() / solver;
        const Outcome outcome =
            run_swage({"run", scene.string(), "--out", run.string(), "--no-render"});
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        return outcome.err.find("implicit steps damp by themselves") != std::string::npos;
    };
    CHECK(told("implicit"));
    CHECK_FALSE(told("explicit"));
}

TEST_CASE("books that hold nothing but round-off are not said to be open") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "still.toml";
    run_swage({"make", "rod", "--length", "10 cm", "--out", "rod.obj"}, scratch.path());
    put_text(scene,
             "[mesh]\nfile = \"rod.obj\"\n[material]\nname = \"silicone\"\n[mold]\nacross = 4\n"
             "[[stage]]\nmachine = \"floor\"\nframes = 4\nduration = \"1 s\"\n");
    const fs::path run = scratch.path() / "run";
    const Outcome outcome =
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render"});
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(outcome.err.find("nothing moves") != std::string::npos);
    CHECK(outcome.err.find("books do not close") == std::string::npos);
}

TEST_CASE("what is amiss with the file of an inset is told as that of a body") {
    const Scratch scratch;
    run_swage({"make", "bar", "--length", "5 cm", "--out", (scratch.path() / "core.obj").string()});
    fs::remove(scratch.path() / "core.mtl");
    const fs::path scene =
        put_small_scene(scratch.path(), 3, "[[inset]]\nname = \"lead\"\nfile = \"core.obj\"\n");
    const Outcome check = run_swage({"check", scene.string()});
    CHECK(check.code == 0);
    INFO(check.err);
    CHECK(check.err.find("core.obj: the material file 'core.mtl' cannot be read") !=
          std::string::npos);
}

TEST_CASE("what comes in several legs of a frame is told of that frame once") {
    const Scratch scratch;
    const fs::path run = scratch.path() / "run";
    const Outcome outcome =
        run_with_bar(scratch.path(),
                     "[mesh]\nfile = \"bar.obj\"\nvelocity = [\"10 m/s\", 0, 0]\n[material]\n"
                     "name = \"rubber\"\n[mold]\nacross = 2\n[[stage]]\nmachine = \"floor\"\n"
                     "drop = \"1 m\"\nmedium_density = 1e9\ngravity = \"9.81 m/s2\"\n"
                     "gravity_strength = \"cos(2*pi*4*t)\"\nframes = 4\nduration = \"0.01 s\"\n");
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(parse_json(bytes_of(run / "run.json")).at("stages").at(0).at("legs") > 8);
    CHECK(outcome.err.find("1-floor, 4 frames from 2 on: the drag is so strong") !=
          std::string::npos);
}

TEST_CASE("the first row of the curves is the start, with what is known of it") {
    const Scratch scratch;
    const fs::path run = scratch.path() / "run";
    const Outcome outcome = run_with_bar(
        scratch.path(),
        "[mesh]\nfile = \"bar.obj\"\nvelocity = [\"2 m/s\", 0, 0]\n[material]\n"
        "name = \"rubber\"\n[mold]\nacross = 2\n[[body]]\nname = \"other\"\n"
        "file = \"bar.obj\"\nat = [0, \"8 cm\", 0]\n[[stage]]\nmachine = \"floor\"\n"
        "drop = \"10 cm\"\nframes = 1\nduration = \"1 ms\"\ngravity = \"9.81 m/s2\"\n");
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    std::istringstream table(bytes_of(run / "curves/1-floor.csv"));
    const auto cells = [&] {
        std::string line, cell;
        std::getline(table, line);
        std::vector<std::string> row;
        for (std::istringstream in(line); std::getline(in, cell, ',');) row.push_back(cell);
        return row;
    };
    const std::vector<std::string> names = cells(), start = cells();
    const auto at_start = [&](const char* name) {
        return start.at(std::size_t(std::find(names.begin(), names.end(), name) - names.begin()));
    };
    const double mass = parse_json(bytes_of(run / "run.json"))
                            .at("bodies")
                            .at(0)
                            .at("matter")
                            .at("mass_kg")
                            .get<double>();
    CHECK(std::stod(at_start("kinetic energy [J]")) == Approx(0.5 * mass * 4).epsilon(1e-6));
    CHECK(at_start("pieces") == "2");
    CHECK(at_start("contact energy [J]") == "0");  // not looked for yet
    // Both bodies weigh the same. What the floor bears is not known yet.
    CHECK(std::stod(at_start("gravity force y [N]")) == Approx(-2 * 9.81 * mass).epsilon(1e-6));
    CHECK(std::stod(at_start("gravity torque y [N m]")) == 0);
    for (const char* name : {"force y [N]", "torque z [N m]", "contacts", "penetration [m]"}) {
        CHECK(at_start((std::string("floor ") + name).c_str()).empty());
    }
    CHECK(at_start("floor work [J]") == "0");
    const Json peaks = parse_json(bytes_of(run / "run.json")).at("stages").at(0).at("peaks");
    CHECK(peaks.at("gravity").at("force_frame") == 2);

    const std::string bodies = bytes_of(run / "curves/1-floor-bodies.csv");
    CHECK(bodies.find("\n1,0,work-piece,") != std::string::npos);
    CHECK(bodies.find("\n2,0.001,other,") != std::string::npos);
}
