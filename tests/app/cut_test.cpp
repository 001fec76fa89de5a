// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "base/srgb.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "pipeline/checkpoint.h"
#include "pipeline/run_identity.h"
#include "skin/new_look.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/box_obj.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

TEST_CASE("a cut through what has flowed unevenly has flat faces", "[stress]") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "gear.toml", out = scratch.path() / "out";
    put_text(scene, "[mesh]\nfile = \"" SWAGE_SOURCE_DIR
                    "/assets/meshes/gear.obj\"\n[material]\nname = \"abs\"\n[mold]\nacross = 3\n"
                    "[[stage]]\nmachine = \"press\"\naxis = \"x\"\ndepth = 0.3\nframes = 1\n"
                    "[[stage]]\nmachine = \"cut\"\naxis = \"z\"\ntilt = \"45 deg\"\nframes = 3\n");
    const Outcome outcome =
        run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const swage::TriMesh mesh = swage::read_mesh(out / "meshes/2-cut.obj");
    const swage::Components parts = swage::surface_components(mesh);
    REQUIRE(parts.count == 2);
    std::vector<swage::Vec3> sum(2, swage::Vec3::Zero());
    std::vector<double> area(2, 0.0);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        if (mesh.material[mesh.triangle_material[t]].name != swage::kCutMaterial) continue;
        const auto [a, b, c] = mesh.triangle[t];
        const swage::Vec3 own =
            (mesh.position[b] - mesh.position[a]).cross(mesh.position[c] - mesh.position[a]);
        sum[parts.triangle_component[t]] += own;
        area[parts.triangle_component[t]] += own.norm();
    }
    for (int part : {0, 1}) CHECK(sum[part].norm() > 0.999 * area[part]);
    // Each of the two is an object.
    CHECK(mesh.part_name == std::vector<std::string>{"gear_piece_1", "gear_piece_2"});
    const int first = parts.triangle_component[0];
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        CHECK((mesh.triangle_part[t] == 0) == (parts.triangle_component[t] == first));
    }
}

TEST_CASE("cut faces have the colour that the scene gives the inside, however the skin is made") {
    const Scratch scratch;
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, scratch.path());
    const fs::path scene = scratch.path() / "cut.toml", out = scratch.path() / "out";
    for (const std::string kind : {"mount", "boundary"}) {
        put_text(scene,
                 "[mesh]\nfile = \"bar.obj\"\ncut_color = [1, 0.5, 0]\n[material]\nname = "
                 "\"copper\"\n[mold]\nacross = 3\n[skin]\nkind = \"" +
                     kind + "\"\n[[stage]]\nmachine = \"slice\"\nslices = 3\nframes = 3\n");
        const Outcome outcome =
            run_swage({"run", scene.string(), "--no-render", "--fresh", "--out", out.string()});
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        const swage::TriMesh mesh = swage::read_mesh(out / "meshes/1-slice.obj");
        CHECK(swage::surface_components(mesh).count == 3);
        int cut = 0;
        for (const swage::SurfaceMaterial& look : mesh.material) {
            const bool is_cut = look.name == swage::kCutMaterial;
            const swage::Vec3 orange(1, swage::linear_from_srgb(0.5), 0);
            CHECK(((look.color - orange).norm() < 1e-3) == is_cut);
            cut += is_cut;
        }
        CHECK(cut == 1);
    }
}

TEST_CASE("cut faces show what lies inside, in all that a run leaves") {
    const Scratch scratch;
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, scratch.path());
    const fs::path scene = scratch.path() / "cored.toml", out = scratch.path() / "out";
    put_text(scene,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"polyethylene\"\n"
             "[[inset]]\nname = \"copper\"\nfrom = [0, 0.3, 0.2]\nto = [1, 0.7, 0.7]\n"
             "[[inset]]\nname = \"lead\"\nfrom = [0, 0.8, 0]\nto = [1, 1, 1]\n"
             "color = [0, 0, 1]\n"
             "[mold]\nacross = 5\n[[stage]]\nmachine = \"bend\"\nangle = \"3 deg\"\nframes = 1\n"
             "[[stage]]\nmachine = \"slice\"\nslices = 2\nframes = 2\nremold = true\n"
             "[[stage]]\nmachine = \"slice\"\nslices = 3\nframes = 2\n");
    const Outcome outcome =
        run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    for (const auto& [name, cuts] : {std::pair("2-slice", 1), std::pair("3-slice", 3)}) {
        const swage::TriMesh mesh = swage::read_mesh(out / "meshes" / (std::string(name) + ".obj"));
        CHECK(swage::check_mesh(mesh).watertight);
        CHECK(swage::surface_components(mesh).count == cuts + 1);
        std::map<std::string, double> area;
        for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
            area[mesh.material[mesh.triangle_material[t]].name] +=
                0.5 * swage::area_vector(mesh.position, mesh.triangle[t]).norm();
        }
        // Bent and sliced across, nearly.
        const double both = 2 * cuts * 0.02 * 0.02;
        CHECK(area.at("cut_copper") == Approx(0.4 * 0.5 * both).epsilon(0.05));
        CHECK(area.at("cut_lead") == Approx(0.2 * both).epsilon(0.05));
        CHECK(area.at("cut") == Approx(0.6 * both).epsilon(0.05));
        for (const swage::SurfaceMaterial& look : mesh.material) {
            CHECK((look.name == "cut_lead") == ((look.color - swage::Vec3(0, 0, 1)).norm() < 1e-3));
        }
    }
    const fs::path usd = scratch.path() / "all.usda";
    REQUIRE(run_swage({"export", out.string(), "--out", usd.string()}).code == 0);
    for (const char* name : {"cut_copper", "cut_lead"}) {
        CHECK(bytes_of(usd).find(name) != std::string::npos);
    }
}

TEST_CASE("a blade severs as much in one frame as in forty, and nothing more on its way up") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "cut.toml";
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, scratch.path());
    const auto severed = [&](const std::string& frames, const std::string& rising) {
        put_text(scene,
                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 3\n"
                 "[[stage]]\nmachine = \"cut\"\ntilt = \"20 deg\"\nframes = " +
                     frames + "\nrising = " + rising + "\n");
        const fs::path run = scratch.path() / ("run-" + frames + "-" + rising);
        const Outcome outcome =
            run_swage({"run", scene.string(), "--out", run.string(), "--no-render"});
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        const Json stage = parse_json(bytes_of(run / "run.json")).at("stages").at(0);
        CHECK(stage.at("pieces") == 2);
        CHECK(swage::check_mesh(swage::read_mesh(run / "meshes/1-cut.obj")).watertight);
        return stage.at("severed").get<int>();
    };
    const int whole = severed("40", "0");
    for (const char* frames : {"40", "3", "1"}) CHECK(severed(frames, "0.1") == whole);
}

TEST_CASE("a blade severs a body that comes under it when another has been cut") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "late.toml", out = scratch.path() / "out";
    run_swage({"make", "bar", "--length", "20 cm", "--out", (scratch.path() / "bar.obj").string()});
    const std::string bar = "file = \"bar.obj\"\n";
    put_text(scene, "[mesh]\n" + bar +
                        "[material]\nyoung_modulus = \"1 MPa\"\ndensity = \"1000 kg/m3\"\n"
                        "damping_ratio = 0.1\n[mold]\nacross = 2\n[[body]]\nname = \"late\"\n" +
                        bar +
                        "at = [0, \"-4 cm\", \"10 cm\"]\nvelocity = [0, 0, \"-0.8 m/s\"]\n"
                        "[[stage]]\nmachine = \"cut\"\ncutting = 0.9\nrising = 0\npart = 0\n"
                        "clearance = \"6 cm\"\nframes = 20\nduration = \"0.2 s\"\n");
    REQUIRE(run_swage({"run", scene.string(), "--no-render", "--out", out.string()}).code == 0);
    const Json stage = parse_json(bytes_of(out / "run.json")).at("stages").back();
    CHECK(stage.at("severed") > 40);  // 33 in the first
    CHECK(stage.at("pieces") == 3);
}

TEST_CASE("of two bodies the one that no blade cuts is not held as parted") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "beside.toml", out = scratch.path() / "out";
    run_swage({"make", "bar", "--length", "20 cm", "--out", (scratch.path() / "bar.obj").string()});
    const std::string bar = "file = \"bar.obj\"\n";
    put_text(scene, "[mesh]\n" + bar +
                        "[material]\nyoung_modulus = \"1 MPa\"\ndensity = \"1000 kg/m3\"\n"
                        "[mold]\nacross = 2\n[[body]]\nname = \"beside\"\n" +
                        bar +
                        "at = [0, 0, \"1 m\"]\n[[stage]]\nmachine = \"cut\"\nframes = 4\n"
                        "duration = \"20 ms\"\n");
    const Outcome outcome =
        run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    std::string why;
    const std::optional<swage::Reached> reached = swage::read_checkpoint(
        out / "resume/after-1.bin", swage::read_identity(out / ".swage-run").stage_key, why);
    INFO(why);
    REQUIRE(reached);
    REQUIRE(reached->bodies.size() == 2);
    CHECK(reached->bodies[0].is_parted);
    CHECK_FALSE(reached->bodies[1].is_parted);
}

TEST_CASE("info calls what touches manifold by its numbers, and not by place") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "two.obj";
    // Two tetrahedra with an edge at one place.
    const std::string corner = "v 0 0 0\nv 0 0 1\n";
    put_text(file, corner + "v 1 0 0\nv 0 1 0\n" + corner + "v -1 0 0\nv 0 -1 0\n" +
                       "f 1 4 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 5 8 7\nf 5 7 6\nf 5 6 8\nf 6 7 8\n");
    const std::string told = run_swage({"info", file.string()}).out;
    CHECK(told.find("manifold     yes, going by its vertex numbers\n") != std::string::npos);
    CHECK(told.find("by place     not manifold\n") != std::string::npos);
    const Json json = parse_json(run_swage({"info", file.string(), "--json"}).out);
    CHECK(json.at("manifold") == false);
    CHECK(json.at("manifold_as_numbered") == true);
    CHECK(run_swage({"info", SWAGE_SOURCE_DIR "/assets/meshes/bar.obj"}).out.find("by place") ==
          std::string::npos);
}

namespace {

// Boxes of `size` [m], their low corners at every `step` of it from 0 on.
std::string boxes_obj(const swage::Vec3i& count, const swage::Vec3& size, const swage::Vec3& step) {
    std::string text;
    int before = 0;
    for (int i = 0; i < count[0]; ++i)
        for (int j = 0; j < count[1]; ++j)
            for (int k = 0; k < count[2]; ++k, before += 8) {
                const swage::Vec3 low = step.cwiseProduct(swage::Vec3(i, j, k));
                text += swage::test::box_obj(low, low + size, before);
            }
    return text;
}

}  // namespace

TEST_CASE("slices of parts that cells join keep their shape, and each slice is an object") {
    struct Case {
        swage::Vec3i count;
        swage::Vec3 size, step;
        int across;
    };
    const Case one = GENERATE(Case{{1, 1, 3}, {.08, .08, .02}, {.08, .08, .03}, 4},
                              Case{{1, 1, 3}, {.08, .08, .02}, {.08, .08, .031}, 8},
                              Case{{5, 3, 3}, {.02, .02, .02}, {.03, .03, .03}, 4});
    const Scratch scratch;
    const fs::path scene = scratch.path() / "slices.toml", out = scratch.path() / "out";
    put_text(scratch.path() / "parts.obj", boxes_obj(one.count, one.size, one.step));
    put_text(scene, fmt::format("[mesh]\nfile = \"parts.obj\"\n[material]\nname = \"clay\"\n"
                                "[mold]\nacross = {}\n[[stage]]\nmachine = \"slice\"\n"
                                "slices = 3\naxis = \"z\"\nframes = 2\n",
                                one.across));
    const Outcome outcome =
        run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(outcome.err.find("before the cut") == std::string::npos);
    const swage::TriMesh mesh = swage::read_mesh(out / "meshes/1-slice.obj");
    const swage::Components parts = swage::surface_components(mesh);
    REQUIRE(parts.count == one.count.prod());
    for (const double volume : swage::component_volumes(mesh, parts)) {
        CHECK(volume == Approx(one.size.prod()).epsilon(1e-4));
    }
    CHECK(mesh.part_name.size() == 3);
}

TEST_CASE("a blade that grazes takes no layer of matter that the skin would not show") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "graze.toml";
    put_text(scratch.path() / "graze_machine.toml",
             "[parameter.place]\nquantity = \"length\"\ndefault = \"0 m\"\nlow = \"-1 m\"\nhigh = "
             "\"1 m\"\nhelp = \"of the cut\"\n[[blade]]\nname = \"knife\"\n"
             "edge = [[\"place\", \"0.06\", \"-0.5\"], [\"place\", \"0.06\", \"0.5\"]]\n"
             "[blade.motion]\nmove = [\"0\", \"-0.12*t\", 0]\n");
    run_swage({"make", "bar", "--length", "20 cm", "--height", "4 cm", "--width", "6 cm",
               "--rounding", "0 m", "--out", "bar.obj"},
              scratch.path());
    for (const std::string kind : {"mount", "boundary"}) {
        for (const std::string at : {"0.099999", "0.0999", "-0.099999", "0.09"}) {
            CAPTURE(kind, at);
            const fs::path out = scratch.path() / (kind + at);
            put_text(scene,
                     "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = "
                     "3\n[skin]\nkind = \"" +
                         kind +
                         "\"\n[[stage]]\nmachine = \"graze_machine.toml\"\nframes = 2\nplace = \"" +
                         at + " m\"\n");
            const Outcome outcome =
                run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
            INFO(outcome.err);
            REQUIRE(outcome.code == 0);
            const Json stage = parse_json(bytes_of(out / "run.json")).at("stages").back();
            const bool parts = at == "0.09";
            CHECK(stage["pieces"] == (parts ? 2 : 1));
            CHECK(stage["skin_pieces"].size() == (parts ? 1 : 0));
            CHECK((stage["severed"] == 0) == !parts);
            const bool is_told =
                outcome.err.find("severed nothing: what is narrower than a cell") !=
                std::string::npos;
            CHECK(is_told == !parts);
            const swage::TriMesh mesh = swage::read_mesh(out / "meshes/1-graze_machine.obj");
            const bool shows_cut = std::ranges::any_of(
                mesh.material, [](const auto& one) { return one.name == swage::kCutMaterial; });
            CHECK(shows_cut == parts);
        }
    }
}

TEST_CASE("a blade near an end parts skin and matter alike, or neither") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "end.toml";
    run_swage({"make", "bar", "--out", "bar.obj"}, scratch.path());
    struct Case {
        std::string mesh;
        int across;
        std::string place;
        int pieces;
    };
    // Half a cell of the bar is a twentieth of it, in four particles; the tip of the calf less than
    // a hundredth.
    const std::vector<Case> cases = {{"bar.obj", 1, "0.46", 2},
                                     {SWAGE_SOURCE_DIR "/assets/meshes/calf.obj", 3, "0.47", 1}};
    for (const std::string kind : {"mount", "boundary"}) {
        for (const Case& one : cases) {
            CAPTURE(kind, one.mesh);
            const fs::path out = scratch.path() / fmt::format("{}-{}", kind, one.across);
            put_text(scene, fmt::format("[mesh]\nfile = \"{}\"\n[material]\nname = \"rubber\"\n"
                                        "[mold]\nacross = {}\n[skin]\nkind = \"{}\"\n"
                                        "[[stage]]\nmachine = \"cut\"\ngrip_length = 0.01\n"
                                        "place = {}\nframes = 3\n",
                                        one.mesh, one.across, kind, one.place));
            const Outcome outcome =
                run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
            INFO(outcome.err);
            REQUIRE(outcome.code == 0);
            const Json stage = parse_json(bytes_of(out / "run.json")).at("stages").back();
            const bool parts = one.pieces > 1;
            CHECK(stage["pieces"] == one.pieces);
            CHECK((stage["severed"] > 0) == parts);
            const auto tells = [&](const char* words) {
                return outcome.err.find(words) != std::string::npos;
            };
            CHECK(tells("the blade went into matter but severed nothing") == !parts);
            CHECK(tells("the blade left crumbs of less than one cell") == parts);
            CHECK_FALSE(tells("the blade met no matter"));
            const swage::TriMesh mesh = swage::read_mesh(out / "meshes/1-cut.obj");
            const bool shows_cut = std::ranges::any_of(
                mesh.material, [](const auto& look) { return look.name == swage::kCutMaterial; });
            CHECK(shows_cut == parts);
            CHECK(mesh.part_name.size() == (parts ? 2 : 0));
        }
    }
}
