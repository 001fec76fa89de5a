// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <array>
#include <sstream>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

namespace {

int code_of(const std::vector<std::string>& argument) {
    return run_swage(argument, SWAGE_SOURCE_DIR).code;
}

}  // namespace

TEST_CASE("a wrong command line ends with 2 and a hint") {
    CHECK(code_of({}) == 2);
    CHECK(code_of({"run"}) == 2);
    CHECK(code_of({"info", "--threads", "0", "assets/meshes/bar.obj"}) == 2);
    CHECK(code_of({"info", "--threads", "two", "assets/meshes/bar.obj"}) == 2);
    CHECK(code_of({"info", "--quiet", "--verbose", "assets/meshes/bar.obj"}) == 2);
    for (const char* frames : {"0-3", "5-2", "x", "-", "-2", "1-2-3", "1.5", "1,3", "1--2"}) {
        const Outcome refused = run_swage({"run", "a.toml", std::string("--frames=") + frames});
        CHECK(refused.code == 2);
        CHECK(refused.err.find("error: --frames: \"") == 0);
    }
    for (const char* size : {"0x10", "10", "axb", "99999x5", "10x10x10"}) {
        CHECK(code_of({"render", "somewhere", std::string("--size=") + size}) == 2);
    }
    for (const char* angle : {"--camera-azimuth", "--camera-zoom", "--field-of-view"}) {
        CHECK(code_of({"render", "somewhere", angle, "nan"}) == 2);
    }
    const std::vector<std::string> eye = {"render", "somewhere", "--camera-eye", "1", "2", "3"};
    CHECK(code_of(eye) == 2);  // looks at nothing
    std::vector<std::string> both = eye;
    for (const char* word : {"--camera-target", "0", "0", "0", "--camera-zoom", "2"}) {
        both.push_back(word);
    }
    CHECK(code_of(both) == 2);
    const Outcome command = run_swage({"chekc", "a.toml"});
    CHECK(command.code == 2);
    CHECK(command.out.empty());
    CHECK(command.err.find("did you mean \"check\"?") != std::string::npos);
    CHECK(run_swage({"run", "a.toml", "--no-rendr"}).err.find("--no-render") != std::string::npos);
    CHECK(run_swage({"machines", "bnd"}).err.find("\"bend\"") != std::string::npos);
    CHECK(code_of({"machines", "bnd"}) == 2);
    CHECK(code_of({"make", "bra"}) == 2);
    CHECK(code_of({"make", "bar", "--length", "10 kg", "--out", "/nowhere/bar.obj"}) == 2);
    CHECK(code_of({"make", "bar", "--length", "-1", "--out", "/nowhere/bar.obj"}) == 2);
    CHECK(code_of({"make", "bar", "--out", "/tmp/bar.step"}) == 2);
}

TEST_CASE("a wrong scene ends with 3, a wrong mesh with 4, and nothing is written") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    const fs::path run = scratch.path() / "run";
    const auto try_scene = [&](const std::string& key, const std::string& value) {
        const Outcome outcome = run_swage({"run", scene.string(), "--out", run.string(),
                                           "--no-render", "--set", key + "=" + value});
        CHECK_FALSE(fs::exists(run));
        return outcome.code;
    };
    CHECK(try_scene("stage.1.anlge", "3 deg") == 3);
    CHECK(try_scene("stage.1.angle", "3 kg") == 3);
    CHECK(try_scene("stage.1.machine", "bnd") == 3);
    CHECK(try_scene("material.density", "-1") == 3);
    CHECK(try_scene("mesh.file", "none.obj") == 4);
    put_text(scratch.path() / "broken.obj", "v 0 0 nan\nf 1 2 3\n");
    CHECK(try_scene("mesh.file", "broken.obj") == 4);
    fs::create_directory(scratch.path() / "folder.obj");
    CHECK(try_scene("mesh.file", "folder.obj") == 4);
    CHECK(code_of({"info", (scratch.path() / "none.obj").string()}) == 4);
    CHECK(code_of({"check", (scratch.path() / "none.toml").string()}) == 3);
}

TEST_CASE("what would need too much is refused with 7 before anything is done") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    for (const char* set : {"mold.across=5000", "stage.1.frames=1000000000"}) {
        const Outcome outcome = run_swage(
            {"run", scene.string(), "--out", (scratch.path() / "run").string(), "--set", set});
        INFO(outcome.err);
        CHECK(outcome.code == 7);
        CHECK_FALSE(fs::exists(scratch.path() / "run" / "frames"));
        CHECK(code_of({"check", scene.string(), "--set", set}) == 7);
    }
}

TEST_CASE("check tells every mistake at once, with its place, and as JSON") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 3, "colour = \"red\"\nfps = \"many\"\n");
    const Outcome outcome = run_swage({"check", scene.string()});
    CHECK(outcome.code == 3);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.find("small.toml:13:1: ") != std::string::npos);
    CHECK(outcome.err.find("small.toml:14:") != std::string::npos);
    const Outcome json = run_swage({"check", scene.string(), "--json"});
    CHECK(json.code == 3);
    CHECK(parse_json(json.out).at("mistakes").size() == 2);
}

TEST_CASE("all of a machine's parameters that the work-piece does not allow are told at once") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "wrong.toml";
    run_swage({"make", "bar", "--length", "20 cm", "--out", "bar.obj"}, scratch.path());
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 3\n"
             "[[stage]]\nmachine = \"bend\"\nradius = \"90 cm\"\npusher_radius = \"40 cm\"\n");
    const Outcome outcome = run_swage({"check", scene.string()});
    INFO(outcome.err);
    CHECK(outcome.code == 3);
    CHECK(outcome.err.find("wrong.toml:9:10: machine bend: radius = 90 cm is out of range") !=
          std::string::npos);
    CHECK(outcome.err.find("wrong.toml:10:17: machine bend: pusher_radius = 40 cm is out of") !=
          std::string::npos);
    CHECK(outcome.err.find("the default of") == std::string::npos);
    const Json json = parse_json(run_swage({"check", scene.string(), "--json"}).out);
    CHECK(json.at("mistakes").size() == 2);
}

TEST_CASE("a mistake that only the mesh shows has its place in JSON, as those before it have") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    const auto mistake = [&](const char* set) {
        const Json json =
            parse_json(run_swage({"check", scene.string(), "--json", "--set", set}).out);
        return json.at("mistakes").at(0);
    };
    put_text(scene, bytes_of(scene) + "[[stage]]\nmachine = \"bend\"\n");
    Json json = mistake("mold.across=5000");
    CHECK(json.value("file", "") == "--set mold.across=5000");
    CHECK(json.value("line", -1) == 0);
    CHECK(json.value("column", -1) == 0);
    CHECK(json.at("text").get<std::string>().find("small.toml") == std::string::npos);
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[[stage]]\n"
             "machine = \"bend\"\nradius = \"90 cm\"\n");
    json = mistake("mold.across=3");
    CHECK(json.value("file", "") == scene.string());
    CHECK(json.value("line", -1) == 7);
    CHECK(json.value("column", -1) == 10);
    CHECK(json.at("text").get<std::string>().rfind("machine bend: radius = 90 cm is out", 0) == 0);
    CHECK(json.at("warning") == false);
}

TEST_CASE("check tells before a run what a later stage would say against its parameters") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "two.toml";
    run_swage({"make", "bar", "--length", "20 cm", "--out", "bar.obj"}, scratch.path());
    const auto told = [&](const char* radius) {
        put_text(scene, std::string("[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
                                    "[mold]\nacross = 3\n[[stage]]\nmachine = \"twist\"\n"
                                    "frames = 2\n[[stage]]\nmachine = \"bend\"\nradius = \"") +
                            radius + "\"\n");
        const std::string mistake = "two.toml:12:10: machine bend: radius = ";
        const Outcome check = run_swage({"check", scene.string()});
        CHECK(check.code == 0);
        const bool is_told = check.err.find(mistake) != std::string::npos;
        const Outcome quiet = run_swage({"check", scene.string(), "--quiet"});
        CHECK((quiet.err.find(mistake) != std::string::npos) == is_told);
        CHECK(quiet.out.empty());
        const Outcome run = run_swage({"run", scene.string(), "--no-render"}, scratch.path());
        const std::size_t first = run.err.find(mistake);
        CHECK((first != std::string::npos) == is_told);
        CHECK((first < run.err.find("simulate: ")) == is_told);
        return is_told;
    };
    CHECK(told("90 cm"));  // three lengths is the most
    CHECK_FALSE(told("3 cm"));
}

TEST_CASE("check tells what a run will cost, and the run costs it") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    const Outcome outcome = run_swage({"check", scene.string(), "--json"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const Json cost = parse_json(outcome.out).at("cost");
    CHECK(cost.at("cells") == 40);
    CHECK(cost.at("particles") == 99);
    CHECK(cost.at("frames") == 4);
    CHECK(cost.at("steps").get<double>() > 100);
    CHECK(cost.at("memory_bytes").get<double>() > 1e7);
    CHECK(cost.at("disk_bytes").get<double>() > 1e4);
    const std::string text = run_swage({"check", scene.string()}).out;
    for (const char* word : {"cells", "particles", "connections", "memory", "steps", "disk"}) {
        CHECK(text.find(word) != std::string::npos);
    }
}

TEST_CASE("a skin is closed where matter breaks, also where a blade has cut before", "[stress]") {
    const Scratch scratch;
    const fs::path mesh = scratch.path() / "bar.obj", scene = scratch.path() / "glass.toml";
    run_swage({"make", "bar", "--length", "10 cm", "--out", mesh.string()});
    const std::string stretch = "[[stage]]\nmachine = \"stretch\"\nframes = 2\n",
                      cut_and_drop =
                          "[[stage]]\nmachine = \"cut\"\nframes = 8\n[[stage]]\nmachine = "
                          "\"floor\"\ndrop = \"1 cm\"\ngravity = \"5000 m/s2\"\n"
                          "duration = \"3 ms\"\nframes = 6\n";
    for (const std::string& stages : {stretch, cut_and_drop}) {
        for (const std::string kind : {"mount", "boundary"}) {
            put_text(scene,
                     "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"glass\"\n[mold]\n"
                     "across = 3\n" +
                         stages + "[skin]\nkind = \"" + kind + "\"\n");
            const fs::path out = scratch.path() / (kind + std::to_string(stages.size()));
            const Outcome run =
                run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
            INFO(run.err);
            REQUIRE(run.code == 0);
            CHECK(run.err.find("could not be closed") == std::string::npos);
            // The splinters have left the floor again by the end of the frame.
            CHECK(run.err.find("never touched") == std::string::npos);
            const Json record = parse_json(bytes_of(out / "run.json")).at("stages").back();
            CHECK(record.at("broken") > 0);
            CHECK(record.at("pieces") > 2);
            const std::string name = record.at("name").get<std::string>() + ".obj";
            const Json info =
                parse_json(run_swage({"info", (out / "meshes" / name).string(), "--json"}).out);
            CHECK(info.at("watertight") == true);
            CHECK(info.at("components") > 1);
        }
    }
}

TEST_CASE("info and machines tell the same in words and in JSON") {
    const Json info = parse_json(run_swage({"info", "assets/meshes/bar.obj", "--json"}).out);
    CHECK(info.at("watertight") == true);
    CHECK(info.at("components") == 1);
    CHECK(info.at("volume_m3").get<double>() > 0);
    CHECK(run_swage({"info", "assets/meshes/bar.obj"}).out.find("watertight") != std::string::npos);

    const Json machines = parse_json(run_swage({"machines", "--json"}).out);
    std::vector<std::string> names;
    for (const Json& machine : machines) names.push_back(machine.at("name").get<std::string>());
    for (const char* name : {"bend", "twist", "cut"}) {
        CHECK(std::find(names.begin(), names.end(), name) != names.end());
    }
    const std::string bend = run_swage({"machines", "bend"}).out;
    CHECK(bend.find("radius") != std::string::npos);
    CHECK(bend.find("deg") != std::string::npos);
}

TEST_CASE("info tells what a run makes of a mesh that bounds no volume, or a wrong one") {
    const Scratch scratch;
    const fs::path seams = scratch.path() / "seams.ply", sheet = scratch.path() / "sheet.ply";
    const auto ply = [](const fs::path& file, const std::vector<std::array<int, 3>>& triangles) {
        const char* corner[] = {"0 0", "1 0", "0 1", "0 0"};
        std::string text = fmt::format(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
            "property float z\nelement face {}\nproperty list uchar int vertex_indices\n"
            "end_header\n",
            3 * triangles.size(), triangles.size());
        double apart = 0;  // no two triangles' corners are at quite the same place
        for (const auto& t : triangles) {
            for (int c : t) text += fmt::format("{} {}\n", corner[c], (c == 3) + apart);
            apart += 1e-5;
        }
        for (std::size_t n = 0; n < triangles.size(); ++n) {
            text += fmt::format("3 {} {} {}\n", 3 * n, 3 * n + 1, 3 * n + 2);
        }
        put_text(file, text);
    };
    ply(seams, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
    ply(sheet, {{0, 2, 1}});
    const std::string mended = run_swage({"info", seams.string()}).out;
    INFO(mended);
    CHECK(mended.find("a run        stitched") != std::string::npos);
    CHECK(mended.find("a run        then: 4 vertices, 4 triangles") != std::string::npos);
    CHECK(run_swage({"info", sheet.string()}).out.find("a run        refuses this mesh: ") !=
          std::string::npos);
    // Two tetrahedra of one volume that is right, and with one of them inside out.
    for (const bool inside_out : {false, true}) {
        const fs::path two = scratch.path() / "two.obj";
        put_text(two, std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n") +
                          "v 3 0 0\nv 5 0 0\nv 3 2 0\nv 3 0 2\n" +
                          "f 5 7 6\nf 5 6 8\nf 6 7 8\nf 5 8 7\n" +
                          (inside_out ? "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n"
                                      : "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"));
        const std::string told = run_swage({"info", two.string()}).out;
        INFO(told);
        const bool repaired = told.find("a run        turned 1 of 2 bodies") != std::string::npos;
        CHECK(repaired == inside_out);
        CHECK((told.find("a run") != std::string::npos) == inside_out);
    }
    const Json bar = parse_json(run_swage({"info", "assets/meshes/bar.obj", "--json"}).out);
    CHECK(bar.at("repairs").empty());
}

TEST_CASE("one's own machine is told where a scene would find it, and by its file") {
    const Scratch scratch;
    fs::create_directory(scratch.path() / "machines");
    put_text(scratch.path() / "machines" / "nose.toml",
             "help = \"nose: pushes\"\n[parameter.depth]\nquantity = \"number\"\n"
             "default = \"0.3\"\n[[tool]]\nname = \"ball\"\nshape = \"sphere\"\n"
             "radius = \"0.2*height\"\nat = [\"0\", \"height\", \"0\"]\n");
    put_text(scratch.path() / "machines" / "bad.toml", "[[tool]]\nname = 3\n");
    const auto told = [&](const std::string& name) {
        return run_swage({"machines", name}, scratch.path());
    };
    for (const char* name : {"nose", "machines/nose.toml"}) {
        const Outcome outcome = told(name);
        INFO(outcome.err);
        CHECK(outcome.code == 0);
        CHECK(outcome.out.find("pushes") != std::string::npos);
        CHECK(outcome.out.find("depth") != std::string::npos);
    }
    CHECK(told("machines/bad.toml").code == 3);
    CHECK(told("machines/bad.toml").err.find("bad.toml:2:8: ") != std::string::npos);
    CHECK(told("machines/none.toml").code == 3);
    const std::string keys = run_swage({"keys", "--machine", "expressions"}).out;
    CHECK(keys.find("ramp(t, a, b)") != std::string::npos);
    CHECK(keys.find("lattice_reach") != std::string::npos);
    CHECK(keys.find("duration") != std::string::npos);
}

TEST_CASE("made meshes are the same to the bit each time, and as large as asked for") {
    const Scratch scratch;
    const fs::path a = scratch.path() / "a.obj", b = scratch.path() / "b.obj";
    for (const fs::path& file : {a, b}) {
        REQUIRE(run_swage({"make", "bar", "--length", "30 cm", "--out", file.string()}).code == 0);
    }
    const Json info = parse_json(run_swage({"info", a.string(), "--json"}).out);
    CHECK(info.at("box_m").at("high").at(0).get<double>() == Approx(0.15));
    std::string first = bytes_of(a), second = bytes_of(b);
    // Each names its own material library.
    CHECK(first.substr(first.find("\nv ")) == second.substr(second.find("\nv ")));
}

TEST_CASE(
    "a made mesh takes no picture's name that something else has, and a wrong ending nothing") {
    const Scratch scratch;
    const fs::path picture = scratch.path() / "x.png", mesh = scratch.path() / "x.obj";
    put_text(picture, "keep");
    CHECK(code_of({"make", "calf", "--out", (scratch.path() / "x.stl").string()}) == 2);
    for (int n = 0; n < 2; ++n) {  // the second time its own is there
        REQUIRE(code_of({"make", "calf", "--texture", "64", "--division", "20", "--out",
                         mesh.string()}) == 0);
        CHECK(bytes_of(picture) == "keep");
        CHECK(bytes_of(scratch.path() / "x.mtl").find("map_Kd x_2.png") != std::string::npos);
        CHECK_FALSE(fs::exists(scratch.path() / "x_3.png"));
    }
}

TEST_CASE("data goes to stdout alone, and --quiet leaves stderr empty") {
    const Outcome info = run_swage({"info", "assets/meshes/bar.obj", "--quiet", "--json"});
    CHECK(info.code == 0);
    CHECK(info.err.empty());
    CHECK_NOTHROW(parse_json(info.out));
}

TEST_CASE("check tells of every body how fine it is, and what it would need") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "two.toml";
    run_swage({"make", "bar", "--length", "20 cm", "--out", "bar.obj"}, scratch.path());
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 3\n"
             "[[body]]\nname = \"pane\"\nfile = \"bar.obj\"\nat = [0, \"10 cm\", 0]\n"
             "material = \"glass\"\nacross = 2\n[[stage]]\nmachine = \"floor\"\n"
             "gravity = \"9.81 m/s2\"\nframes = 1\nduration = \"1 us\"\n");
    const Outcome text = run_swage({"check", scene.string()});
    INFO(text.out << text.err);
    REQUIRE(text.code == 0);
    CHECK(text.out.find("  cells        pane: ") != std::string::npos);
    CHECK(text.out.find("  accuracy     pane: elastic stiffness of a part 2 cells thick") !=
          std::string::npos);
    CHECK(text.out.find("[[body]] \"pane\" across = ") != std::string::npos);
    CHECK(text.out.find("[mold] across = ") == std::string::npos);
    const Json json = parse_json(run_swage({"check", scene.string(), "--json"}).out);
    CHECK(json.at("strength").at(0).at("body") == "pane");
    CHECK(json.at("bodies").at("pane").at("accuracy").contains("bending"));
    CHECK(json.at("cost").at("bodies").size() == 2);
    const fs::path out = scratch.path() / "run";
    const Outcome run = run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    CHECK(run.err.find("[[body]] \"pane\" across = ") != std::string::npos);
    const Json record = parse_json(bytes_of(out / "run.json"));
    REQUIRE_FALSE(json.at("cost").at("warnings").empty());
    CHECK(json.at("cost").at("warnings").at(0) == record.at("warnings").at(0));
}

TEST_CASE("what matter has not as its mesh has it stands in the record, and in what check finds") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "twins.toml";
    std::string twins = "o twins\n";
    for (const double x : {0.0, 1.02}) {
        for (int c = 0; c < 8; ++c) {
            twins += fmt::format("v {} {} {}\n", x + (c & 1), c >> 1 & 1, c >> 2);
        }
    }
    for (const int b : {0, 8}) {
        for (const std::array<int, 4>& f :
             {std::array{1, 3, 4, 2}, std::array{5, 6, 8, 7}, std::array{1, 2, 6, 5},
              std::array{3, 7, 8, 4}, std::array{1, 5, 7, 3}, std::array{2, 4, 8, 6}}) {
            twins += fmt::format("f {} {} {} {}\n", b + f[0], b + f[1], b + f[2], b + f[3]);
        }
    }
    put_text(scratch.path() / "twins.obj", twins);
    put_text(scene,
             "[mesh]\nfile = \"twins.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 3\n"
             "[[stage]]\nmachine = \"hold\"\nframes = 1\n");
    const Json found = parse_json(run_swage({"check", scene.string(), "--json"}).out);
    const fs::path out = scratch.path() / "run";
    run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    const Json record = parse_json(bytes_of(out / "run.json"));
    for (const Json& warnings : {found.at("cost").at("warnings"), record.at("warnings")}) {
        REQUIRE(warnings.size() >= 1);
        CHECK(std::ranges::any_of(warnings, [](const Json& one) {
            return one.get<std::string>().starts_with("mold: 2 separate bodies became 1");
        }));
    }
}
