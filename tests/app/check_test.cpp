// SPDX-License-Identifier: GPL-3.0-or-later
// What `swage check` foretells, and the run then holds.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "geometry/box_mesh.h"
#include "geometry/mesh_write.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

TEST_CASE("the steps that a run takes lie in the range that check tells", "[stress]") {
    const Scratch scratch;
    run_swage({"make", "bar", "--length", "10 cm", "--division", "20", "--out", "bar.obj"},
              scratch.path());
    const auto holds = [&](const std::string& stage, const std::string& material) {
        const fs::path scene = scratch.path() / "scene.toml", out = scratch.path() / "run";
        put_text(scene, "[mesh]\nfile = \"bar.obj\"\n[material]\n" + material +
                            "[mold]\nacross = 2\n[[stage]]\nframes = 4\nmachine = \"" + stage);
        const Json cost = parse_json(run_swage({"check", scene.string(), "--json"}).out).at("cost");
        const Outcome run = run_swage(
            {"run", scene.string(), "--no-render", "--json", "--fresh", "--out", out.string()});
        INFO(stage << material << run.err << cost);
        const Json record = parse_json(run.out).at("stages").at(0);
        const double steps =
            record.at("steps").get<double>() + record.at("iterations").get<double>();
        CHECK(steps >= cost.at("steps_least").get<double>());
        CHECK(steps <= cost.at("steps_most").get<double>());
        CHECK(cost.at("seconds_least") < cost.at("seconds"));
        CHECK(cost.at("seconds") < cost.at("seconds_most"));
    };
    const std::string rubber = "name = \"rubber\"\n", copper = "name = \"copper\"\n",
                      clay = "name = \"clay\"\n", ice = "name = \"ice\"\n";
    for (const std::string& of : {rubber, copper}) {
        holds("bend\"\nangle = \"20 deg\"\n", of);
        holds("twist\"\nangle = \"20 deg\"\n", of);
    }
    holds("bend\"\nangle = \"5 deg\"\n", ice);
    for (const char* cuts : {"cut", "carve", "slice"}) {
        holds(std::string(cuts) + "\"\n", rubber);
    }
    const std::string floor = "floor\"\ngravity = 9.81\nduration = \"4 ms\"\ndrop = \"0.1 mm\"\n";
    holds(floor, rubber);
    holds(floor, clay);
    holds("twist\"\nsolver = \"explicit\"\nduration = \"4 ms\"\n", copper);
    const std::string by_euler =
        "floor\"\nsolver = \"euler\"\ngravity = 9.81\nduration = \"1 ms\"\n";
    for (const char* ratio : {"0.2", "0.4", "0.49"}) {
        holds(by_euler, rubber + "poisson_ratio = " + ratio + "\n");
    }
    holds(by_euler, rubber + "damping_ratio = 0.25\n");
    const std::string by_energy =
        "floor\"\nsolver = \"energy-stepped\"\ngravity = 9.81\nduration = \"8 ms\"\n"
        "drop = \"0.1 mm\"\n";
    for (const char* ratio : {"0.005", "0.05", "0.3"}) {
        holds(by_energy, rubber + "damping_ratio = " + ratio + "\n");
    }
    holds("twist\"\nsolver = \"energy-stepped\"\nduration = \"4 ms\"\n", rubber);
    holds("bend\"\nsolver = \"implicit\"\nangle = \"5 deg\"\nduration = \"20 ms\"\n", rubber);
}

TEST_CASE("what a run leaves on the disk, stills too, lies in the range that check tells") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 9), out = scratch.path() / "run";
    const Json cost = parse_json(run_swage({"check", scene.string(), "--json"}).out).at("cost");
    REQUIRE(run_swage({"run", scene.string(), "--out", out.string()}).code == 0);
    double taken = 0;
    for (const auto& [name, bytes] : files_below(out)) taken += static_cast<double>(bytes.size());
    INFO(taken << cost);
    CHECK(taken > cost.at("disk_bytes_least").get<double>());
    CHECK(taken < cost.at("disk_bytes").get<double>());
}

TEST_CASE("a slab that its spacing does not divide is told in the layers that it lies in") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "slab.toml";
    swage::write_obj(scratch.path() / "slab.obj", swage::box_mesh({0, 0, 0}, {0.1, 0.02, 0.06}));
    put_text(scene,
             "[mesh]\nfile = \"slab.obj\"\n[material]\nname = \"glass\"\n[mold]\n"
             "spacing = \"4.762 mm\"\n[[stage]]\nmachine = \"hold\"\nframes = 1\n");
    const auto told = [&](const std::string& set) {
        return run_swage({"check", scene.string(), "--set", set}).out;
    };
    const std::string uneven = told("mold.spacing=4.762 mm");
    INFO(uneven);
    CHECK(uneven.find("of a part 4.2 cells thick: within about 5.2 % in bending") !=
          std::string::npos);
    CHECK(uneven.find("the thinnest side is 4.2 cells, so its outermost layers are filled to 0.6: "
                      "across = 4 or spacing = \"5 mm\" gives whole layers") != std::string::npos);
    const std::string even = told("mold.spacing=5 mm");
    CHECK(even.find("of a part 4 cells thick: within about 5.7 % in bending") != std::string::npos);
    CHECK(even.find("whole layers") == std::string::npos);
}

TEST_CASE("a tube's accuracy is told of the whole and of its wall, and as elastic") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "tube.toml";
    run_swage({"make", "tube", "--length", "20 cm", "--diameter", "3 cm", "--wall", "3.5 mm",
               "--out", "tube.obj"},
              scratch.path());
    const std::string rest = "\"\n[mold]\nacross = 6\n[[stage]]\nmachine = \"hold\"\nframes = 1\n";
    put_text(scene, "[mesh]\nfile = \"tube.obj\"\n[material]\nname = \"glass" + rest);
    const std::string text = run_swage({"check", scene.string()}).out;
    INFO(text);
    CHECK(text.find("elastic stiffness of the whole, 6 cells across, ") != std::string::npos);
    CHECK(text.find("within about 2.5 % in bending, 3.4 % in torsion; 1 % at across = 12") !=
          std::string::npos);
    CHECK(
        text.find("bend by themselves (a ring squeezed flat, a bracket): too few cells; 1 % at") !=
        std::string::npos);
    CHECK(text.find("permanent deformation") == std::string::npos);
    const Json json = parse_json(run_swage({"check", scene.string(), "--json"}).out);
    CHECK(json.at("accuracy_of_whole").at("across_for_percent") == 12);
    CHECK(json.at("accuracy").at("across_for_percent").get<int>() > 90);
    // A mesh that says how it looks hides how its material does.
    CHECK(text.find("  look         as in the mesh file; look = \"material\" shows") !=
          std::string::npos);
    CHECK(
        run_swage({"check", scene.string(), "--set", "mesh.look=material"}).out.find("  look  ") ==
        std::string::npos);
    put_text(scene, "[mesh]\nfile = \"tube.obj\"\n[material]\nname = \"copper" + rest);
    CHECK(run_swage({"check", scene.string()}).out.find("permanent deformation") !=
          std::string::npos);
}

TEST_CASE("check refuses more cells than a mold may have, as the run does, and says what to set") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1);
    for (const char* command : {"check", "run"}) {
        const Outcome outcome =
            run_swage({command, scene.string(), "--set", "mold.across=300"}, scratch.path());
        INFO(outcome.out << outcome.err);
        CHECK(outcome.code == 7);
        CHECK(
            outcome.err.find("are more than [mold] cell_limit = 50,000,000: use a larger spacing, "
                             "or set cell_limit higher") != std::string::npos);
    }
}

TEST_CASE("a fineness that does not fit the mesh is told where the scene says it") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 1);  // its [mold] is lines 5 and 6
    const std::string text = bytes_of(scene);
    const auto check = [&](const std::string& mold, const std::vector<std::string>& more, int code,
                           const std::string& words) {
        std::string other = text;
        other.replace(other.find("across = 2"), 10, mold);
        put_text(scene, other);
        std::vector<std::string> arguments = {"check", scene.string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome told = run_swage(arguments);
        INFO(mold << ": " << told.err);
        CHECK(told.code == code);
        CHECK(says(told.err, words));
    };
    check("spacing = \"10 m\"", {}, 4, "small.toml:6:11: cannot mold: the mesh is 0.02 m across");
    check("across = 100000", {}, 7, "small.toml:6:10: refused to mold");
    check("cell_limit = 3", {}, 7, "small.toml:6:14: refused to mold");
    check("cell_limit = 1_000_000_001", {}, 3, "it must be 1 to 1000000000");
    check("across = 2", {"--set", "mold.spacing=1 m"}, 4, "--set mold.spacing=1 m: cannot mold");
    // Of another body, which says it itself or is too thin for what the work-piece says.
    const std::string body = "\n[[body]]\nfile = \"bar.obj\"\nat = [0, 1, 0]\n";
    check("across = 2" + body + "spacing = 3", {}, 4, "small.toml:10:11: body-2: cannot mold");
    check("spacing = \"1 cm\"" + body + "length = \"2 cm\"", {}, 4,
          "small.toml:6:11: body-2: cannot mold");
    check("kind = \"block\"", {}, 0, "");  // of the default nothing is said
}

TEST_CASE("of many bodies that are alike each thing is said once, by check and by the run") {
    const Scratch scratch;
    put_small_scene(scratch.path());  // its mesh
    put_text(scratch.path() / "open.obj", [&] {
        std::string mesh = bytes_of(scratch.path() / "bar.obj");
        mesh.resize(mesh.rfind("f "));  // a face is missing
        return mesh + "usemtl none\n";
    }());
    const auto lines = [&](int bodies, const char* command) {
        std::string text =
            "[mesh]\nfile = \"open.obj\"\nat = [0, 0, 0]\n[material]\nname = \"glass\"\n"
            "[mold]\nacross = 2\n";
        for (int b = 1; b < bodies; ++b) {
            text += fmt::format("[[body]]\nfile = \"open.obj\"\nat = [0, \"{} cm\", 0]\n", 5 * b);
        }
        text +=
            "[[stage]]\nmachine = \"floor\"\nframes = 1\nduration = \"10 us\"\n"
            "gravity = 9.81\n";
        put_text(scratch.path() / "many.toml", text);
        std::vector<std::string> words = {command, "many.toml"};
        if (std::string(command) == "run") {
            words.insert(words.end(), {"--no-render", "--fresh", "--out", "many"});
        }
        const Outcome outcome = run_swage(words, scratch.path());
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        return outcome.out + outcome.err;
    };
    // Up to its start; what each has borne is told in the end.
    const auto count = [](const std::string& text) {
        const auto start = std::min(text.find("simulate"), text.size());
        return std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(start), '\n');
    };
    const std::string check = lines(4, "check"), run = lines(4, "run");
    INFO(check << run);
    CHECK(check.find("all 4 bodies, each: ") != std::string::npos);
    CHECK(check.find("(all 4 bodies)") != std::string::npos);  // cells too large for glass
    CHECK(run.find("molded all 4 bodies, each: ") != std::string::npos);
    CHECK(run.find("open.obj: no material file defines the material 'none': left grey (all 4 "
                   "bodies)") != std::string::npos);
    CHECK(count(lines(9, "check")) <= count(check));
    CHECK(count(lines(9, "run")) <= count(run));
    const Json record = parse_json(bytes_of(scratch.path() / "many" / "run.json"));
    CHECK(record.at("warnings").size() < 9);
    const Json told = parse_json(run_swage({"check", "many.toml", "--json"}, scratch.path()).out);
    CHECK(told.at("meshes").size() == 9);
    CHECK(told.at("cost").at("bodies").size() == 9);
}

TEST_CASE("a scene that cannot run here is not said to be without mistakes and no more") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml";
    swage::write_obj(scratch.path() / "bar.obj", swage::box_mesh({0, 0, 0}, {0.02, 0.2, 0.02}));
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\n"
             "across = 2\n[[stage]]\nmachine = \"floor\"\ngravity = 9.81\nduration = \"1e8 s\"\n");
    const Outcome refused = run_swage({"check", scene.string()});
    CHECK(refused.code == 7);
    CHECK(refused.out.find("scene: no mistakes, but it cannot run here\n") == 0);
}

TEST_CASE("who checks a run is told what tells of it") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", out = scratch.path() / "run";
    swage::write_obj(scratch.path() / "bar.obj", swage::box_mesh({0, 0, 0}, {0.02, 0.2, 0.02}));
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\n"
             "across = 2\n[[stage]]\nmachine = \"bend\"\nframes = 1\n");
    REQUIRE(run_swage({"run", scene.string(), "--no-render", "--out", out.string()}).code == 0);
    for (const fs::path& run : {out, out / "run.json"}) {
        const Outcome told = run_swage({"check", run.string()});
        INFO(told.err);
        CHECK(told.code == 3);
        CHECK(told.err.find("is a run, no scene: `swage info " + out.string() + "` tells of it") !=
              std::string::npos);
    }
}

TEST_CASE("the accuracy of a body with insets is said to be without them") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml";
    swage::write_obj(scratch.path() / "bar.obj", swage::box_mesh({0, 0, 0}, {0.02, 0.2, 0.02}));
    const auto told = [&](const std::string& inset) {
        put_text(scene,
                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\n"
                 "across = 2\n" +
                     inset + "[[stage]]\nmachine = \"bend\"\n");
        return run_swage({"check", scene.string()}).out;
    };
    const std::string of = "of one material, without its insets";
    CHECK(told("").find(of) == std::string::npos);
    CHECK(told("[[inset]]\nname = \"lead\"\nto = [1, 0.5, 1]\n").find(of) != std::string::npos);
}

TEST_CASE("of what is elastic and does not rest check tells the steps of motion to the step") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", out = scratch.path() / "run";
    swage::write_obj(scratch.path() / "bar.obj", swage::box_mesh({0, 0, 0}, {0.1, 0.02, 0.02}));
    const auto steps = [&](const std::string& stage, double lighter = 1) {
        put_text(scene,
                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\n"
                 "across = 2\n[[stage]]\nsolver = \"explicit\"\nsleep = false\n" +
                     stage);
        const Json cost = parse_json(run_swage({"check", scene.string(), "--json"}).out).at("cost");
        const Outcome run = run_swage(
            {"run", scene.string(), "--no-render", "--json", "--fresh", "--out", out.string()});
        INFO(stage << run.err << cost);
        const double taken = parse_json(run.out).at("stages").at(0).at("steps").get<double>();
        const double least = cost.at("steps_least").get<double>();
        CHECK(least <= taken);
        CHECK(taken <= lighter * least);
        CHECK(cost.at("steps_most").get<double>() == std::round(lighter * least));
        return taken;
    };
    // Of frames of a few steps and a bit more than one each takes one more.
    const std::string hold = "machine = \"hold\"\nduration = \"10 ms\"\ngravity = 9.81\nframes = ";
    const double few = steps(hold + "1\n"), many = steps(hold + "30\n");
    CHECK(many > few);
    CHECK(many < few + 30);
    // A load that jumps has legs of its own.
    const std::string jumps =
        "[[stage.load]]\nforce = [0, \"1 N\", 0]\non = \"right\"\n"
        "strength = \"t > 0.37\"\n";
    CHECK(steps(hold + "2\n" + jumps) > steps(hold + "2\n"));
    // What a blade may part takes the steps of its springs; what its pieces weigh is not known.
    const std::string cut = "machine = \"cut\"\nduration = \"10 ms\"\nframes = 3\n";
    steps(cut, 1.1);
    // Frames that end in a fall.
    steps(
        "machine = \"floor\"\ngravity = 9.81\nduration = \"110 ms\"\nframes = 7\n"
        "drop = \"5 cm\"\n");
}

TEST_CASE("a toughness that check advises is none that it then asks about") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "brittle.toml";
    const std::string material = GENERATE("glass", "ice", "concrete");
    const double length = GENERATE(0.02, 0.2, 2.0, 20.0);
    INFO(material << ", " << length);
    swage::write_obj(scratch.path() / "bar.obj",
                     swage::box_mesh({0, 0, 0}, {length, 0.2 * length, 0.2 * length}));
    put_text(scene, "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"" + material +
                        "\"\n[mold]\nacross = 4\n[[stage]]\nmachine = \"bend\"\n");
    const auto check = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words = {"check", scene.string()};
        words.insert(words.end(), more.begin(), more.end());
        return run_swage(words);
    };
    const std::string told = check({}).out, advised = "a toughness of ";
    INFO(told);
    const std::size_t at = told.find(advised);
    if (at == std::string::npos) {
        CHECK(says(told, "do not resolve") ==
              says(told, "it takes more toughness than any " + material + " has"));
        return;
    }
    const std::size_t begin = at + advised.size(), end = told.find('\n', begin);
    const Outcome taken = check({"--set", "material.toughness=" + told.substr(begin, end - begin)});
    INFO(taken.err << taken.out);
    CHECK(taken.code == 0);
    CHECK_FALSE(says(taken.err, "unit"));
    CHECK_FALSE(says(taken.out, "do not resolve"));
}

TEST_CASE("pictures larger than can be drawn are refused before a run, and the largest is told") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path()), run = scratch.path() / "run";
    const std::vector<std::string> large = {"--set", "render.size=[15000, 7500]", "--set",
                                            "render.passes=[\"depth\"]"};
    const std::string why =
        "OpenGL cannot draw pictures of 15000 x 7500 pixels with their passes here, at most ";
    for (std::vector<std::string> words : {std::vector<std::string>{"check", scene.string()},
                                           {"run", scene.string(), "--out", run.string()}}) {
        words.insert(words.end(), large.begin(), large.end());
        const Outcome outcome = run_swage(words);
        INFO(outcome.err);
        if (outcome.code == 7) return;  // of so large ones there is no memory here
        CHECK(outcome.code == 5);
        CHECK_FALSE(fs::exists(run));
        const std::size_t at = outcome.err.find(why);
        int width = 0, height = 0;
        REQUIRE(at != std::string::npos);
        REQUIRE(std::sscanf(outcome.err.c_str() + at + why.size(), "%d x %d", &width, &height) ==
                2);
        CHECK(width == Approx(2 * height).margin(1));
        // And so large a one is taken.
        const std::string size = fmt::format("render.size=[{}, {}]", width, height);
        CHECK(run_swage(
                  {"check", scene.string(), "--set", size, "--set", "render.passes=[\"depth\"]"})
                  .code == 0);
    }
}

TEST_CASE("check tells of a gap that cells fill, however many they are") {
    const Scratch scratch;
    // Two prongs along x, 0.4 mm apart.
    std::string mesh;
    const double low = 0.010, high = 0.0104, top = 0.0204, root = 0.010, end = 0.040;
    const double corner[8][2] = {{0, 0},       {end, 0},    {end, low}, {root, low},
                                 {root, high}, {end, high}, {end, top}, {0, top}};
    for (const double z : {0.0, 0.010}) {
        for (const auto& [x, y] : corner) mesh += fmt::format("v {} {} {}\n", x, y, z);
    }
    const int half[6][3] = {{1, 2, 4}, {2, 3, 4}, {1, 4, 5}, {1, 5, 8}, {5, 6, 7}, {5, 7, 8}};
    for (const auto& [a, b, c] : half) {
        mesh += fmt::format("f {} {} {}\nf {} {} {}\n", a, c, b, a + 8, b + 8, c + 8);
    }
    for (int n = 1; n <= 8; ++n) {
        mesh += fmt::format("f {0} {1} {3} {2}\n", n, n % 8 + 1, n + 8, n % 8 + 9);
    }
    put_text(scratch.path() / "fork.obj", mesh);
    const fs::path scene = scratch.path() / "fork.toml";
    put_text(scene,
             "[mesh]\nfile = \"fork.obj\"\n[material]\nname = \"rubber\"\n"
             "[mold]\nspacing = \"0.285 mm\"\n[[stage]]\nmachine = \"hold\"\n");
    const auto check = [&](const std::string& spacing) {
        return run_swage({"check", scene.string(), "--set", "mold.spacing=" + spacing});
    };
    for (const char* spacing : {"0.5 mm", "0.285 mm"}) {
        const Outcome outcome = check(spacing);
        INFO(outcome.err << outcome.out);
        CHECK(outcome.code == 0);
        CHECK(says(outcome.out, "cells        about ") == (spacing == std::string("0.285 mm")));
        CHECK(says(outcome.err, fmt::format("a gap in the mesh of about 400 um is too narrow for "
                                            "cells of {}",
                                            spacing[2] == '5' ? "500 um" : "285 um")));
        CHECK(says(outcome.err, "spacing = \"200 um\" keeps it open"));
    }
    CHECK_FALSE(says(check("200 um").err, "gap"));
}
