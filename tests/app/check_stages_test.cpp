// SPDX-License-Identifier: GPL-3.0-or-later
// What `swage check` tells of a scene's stages.
#include <cmath>

#include "geometry/box_mesh.h"
#include "geometry/mesh_write.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

TEST_CASE("check, the log and the record tell how a machine stands and what its loads act on") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "upright.toml", out = scratch.path() / "run";
    swage::write_obj(scratch.path() / "bar.obj", swage::box_mesh({0, 0, 0}, {0.02, 0.2, 0.02}));
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 2\n"
             "[[stage]]\nmachine = \"hold\"\nframes = 1\n[[stage.load]]\n"
             "force = [0, \"-0.1 N\", 0]\non = \"right\"\n");
    const std::string axes = "the machine's x, y, z are the world's y, z, x";
    const std::string load = "load_1 acts on 4 cm2 about [10 cm, 0 m, 0 m]";
    const Outcome text = run_swage({"check", scene.string()});
    INFO(text.out << text.err);
    CHECK(text.out.find("  axes         " + axes + "\n") != std::string::npos);
    CHECK(text.out.find("  load         " + load + "\n") != std::string::npos);
    const Outcome run = run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    CHECK(run.err.find("1-hold: " + axes) != std::string::npos);
    CHECK(run.err.find("1-hold: " + load) != std::string::npos);
    const Json told = parse_json(run_swage({"check", scene.string(), "--json"}).out);
    const Json record = parse_json(bytes_of(out / "run.json"));
    for (const char* key : {"name", "axes", "loads"}) {
        CHECK(told.at("stages").at(0).at(key) == record.at("stages").at(0).at(key));
    }
    // The force in the table is along the world's axes. Its first row has every number but for what
    // the vice bears there: its force and torque, depth and contacts.
    const std::string table = bytes_of(out / "curves/1-hold.csv");
    CHECK(table.find("nan") == std::string::npos);
    const auto gaps_in = [&](std::size_t begin, std::size_t end) {
        int gaps = 0;
        for (std::size_t n = begin; n + 1 < end; ++n) gaps += table.compare(n, 2, ",,") == 0;
        return gaps;
    };
    const std::size_t second = table.find("\n2,");
    REQUIRE(second != std::string::npos);
    CHECK(gaps_in(0, second) == 8);
    CHECK(gaps_in(second, table.size()) == 0);
    CHECK(table.find(",0,0,-0.1,") != std::string::npos);
}

TEST_CASE("check tells each stage's solver and why, what its loads push, and how the film goes") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml";
    swage::write_obj(scratch.path() / "bar.obj", swage::box_mesh({0, 0, 0}, {0.02, 0.2, 0.02}));
    const auto check = [&](const std::string& stages, bool json = false) {
        put_text(scene,
                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\n"
                 "across = 2\n" +
                     stages);
        std::vector<std::string> words = {"check", scene.string()};
        if (json) words.push_back("--json");
        return run_swage(words).out;
    };
    const auto has = [](const std::string& text, const std::string& line) {
        return text.find(line) != std::string::npos;
    };
    const std::string hold =
        "[[stage]]\nmachine = \"hold\"\n[[stage.load]]\nforce = [0, \"-0.1 N\", 0]\non = "
        "\"right\"\n[[stage.load]]\npressure = \"2 kPa\"\non = \"top\"\n";
    const std::string held = check(hold);
    INFO(held);
    CHECK(has(held, "  solver       quasistatic, as nothing asks for motion\n"));
    CHECK(has(held, "  load         load_1 pushes with up to 100 mN along the world's -z\n"));
    CHECK(has(held, "  load         load_2 presses with up to 2 kPa\n"));
    const Json json = parse_json(check(hold, true));
    const Json& stage = json.at("stages").at(0);
    CHECK(stage.at("solver") == "quasistatic");
    CHECK(stage.at("solver_chosen_as") == "nothing asks for motion");
    CHECK(std::abs(stage.at("loads").at(0).at("force_N").at(2).get<double>() + 0.1) < 1e-9);
    CHECK(stage.at("loads").at(1).at("pressure_Pa") == 2000);
    CHECK(json.at("cost").at("cells").is_number_integer());
    CHECK(json.at("cost").at("steps_most").is_number_integer());
    CHECK(json.at("cost").at("bodies").at(0).at("cells").is_number_integer());

    const std::string bend = "[[stage]]\nmachine = \"bend\"\n";
    const std::string other = "[[body]]\nfile = \"bar.obj\"\nat = [0, 1, 0]\n";
    CHECK(has(check(other + bend), "  solver       explicit, as there are several bodies\n"));
    const std::string fall = "[[stage]]\nmachine = \"floor\"\ngravity = 9.81\n";
    CHECK(has(check(fall), "  solver       explicit, as machine floor is for motion\n"));
    const std::string meet =
        "  pieces       2-floor: meet each other, as a blade cuts; self_contact = false: they do "
        "not\n";
    const std::string cut = "[[stage]]\nmachine = \"cut\"\n";
    CHECK(has(check(cut + fall), meet));
    CHECK(parse_json(check(cut + fall, true)).at("stages").at(1).at("self_contact") == true);
    for (const std::string& others :
         {cut + fall + "self_contact = false\n", cut + cut, bend + fall, fall + cut}) {
        CHECK(!has(check(others), "  pieces "));
    }
    CHECK(has(check(bend + "solver = \"explicit\"\nduration = \"1 s\"\n" + bend),
              "  solver       1-bend: explicit\n  solver       2-bend: quasistatic, as "));
    const Json film = parse_json(check(bend + "solver = \"explicit\"\nduration = \"1 s\"\n", true))
                          .at("stages")
                          .at(0)
                          .at("film");
    CHECK(film.at("frames") == 60);
    CHECK(film.at("duration_s") == 1.0);
    CHECK(film.at("slower").get<double>() == Approx(2));

    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\nspin = [0, 0, 1]\n[material]\nname = \"rubber\"\n"
             "mechanics = \"springs\"\n[mold]\nacross = 2\n" +
                 bend);
    CHECK(has(run_swage({"check", scene.string()}).out,
              "  solver       explicit, as work-piece starts with a velocity or spin\n"));
    const Json springs = parse_json(run_swage({"check", scene.string(), "--json"}).out);
    CHECK(springs.at("accuracy").at("bending").is_null());
    CHECK(has(springs.at("accuracy").at("note").get<std::string>(), "too stiff in bending"));
}
