// SPDX-License-Identifier: GPL-3.0-or-later
// What a run is told to cost where its matter is too large to be molded for that: larger cells are
// counted in its stead.
#include <algorithm>

#include "base/error.h"
#include "geometry/box_mesh.h"
#include "geometry/make_shape.h"
#include "geometry/mesh_read.h"
#include "geometry/mesh_write.h"
#include "pipeline/cost.h"
#include "scene/read_scene.h"
#include "tests/catch.h"
#include "tests/scene/scene_folder.h"

using namespace swage;

namespace {

struct CountedScene {
    SceneSpec scene;
    std::vector<InputMesh> input;

    CountedScene(const std::string& shape, const std::string& material, const std::string& stage) {
        const test::Scratch scratch;
        scratch.write("shape.obj", "");
        const SceneReading reading = read_scene(
            scratch.write("s.toml", "[mesh]\nfile = \"shape.obj\"\n[material]\nname = \"" +
                                        material + "\"\n[mold]\nacross = 4\n[[stage]]\n" +
                                        "frames = 3\nmachine = " + stage),
            {}, test::shipped());
        for (const Mistake& mistake : reading.mistakes) UNSCOPED_INFO(mistake_text(mistake));
        REQUIRE(reading.scene);
        scene = *reading.scene;
        input.resize(1);
        // Some take seconds to make.
        const std::filesystem::path made = SWAGE_SOURCE_DIR "/assets/meshes/" + shape + ".obj";
        input[0].mesh = exists(made) ? read_mesh(made) : make_shape(shape, {}).mesh;
    }
    RunCost cost(int across, double most) {
        scene.body[0].mold.across = across;
        RunOptions options;
        options.draw = false;
        return count_cost(scene, input, options, most);
    }
};

constexpr double kAll = 1e9, kFew = 3000;

const char* const kBend = "\"bend\"\nangle = \"90 deg\"\n";
const char* const kFloor =
    "\"floor\"\ndrop = \"0 mm\"\ngravity = \"9.81 m/s2\"\nduration = \"1 ms\"\n";
const char* const kPress = "\"press\"\ndepth = 0.3\n";

void check_near(const char* what, double told, double wanted, double factor) {
    INFO(what << " " << told << " of " << wanted);
    CHECK(told < factor * wanted);
    CHECK(told > wanted / factor);
}

}  // namespace

TEST_CASE("what larger cells tell of a run is what its own would, and all that is told of these",
          "[stress]") {
    for (const auto& [shape, material, stage] :
         {std::tuple("wrench", "steel_4340", kBend), std::tuple("calf", "rubber", kFloor),
          std::tuple("calf", "copper", kFloor), std::tuple("sphere", "clay", kPress)}) {
        CountedScene run(shape, material, stage);
        const RunCost whole = run.cost(24, kAll), told = run.cost(24, kFew);
        INFO(shape << " " << material << " " << whole.mold.active_cells);
        REQUIRE(whole.mold.active_cells > 2 * kFew);
        CHECK(whole.counted);
        CHECK_FALSE(told.counted);
        check_near("cells", told.mold.active_cells, whole.mold.active_cells, 1.1);
        check_near("particles", told.mold.particles, whole.mold.particles, 1.1);
        check_near("connections", told.mold.connections, whole.mold.connections, 1.1);
        check_near("matter", told.mold.bytes, whole.mold.bytes, 1.15);
        check_near("least steps", told.steps.least, whole.steps.least, 1.3);
        check_near("most steps", told.steps.most, whole.steps.most, 1.3);
        check_near("least time", told.seconds.least, whole.seconds.least, 1.3);
        check_near("most time", told.seconds.most, whole.seconds.most, 1.3);
        check_near("memory", told.memory_bytes, whole.memory_bytes, 1.1);
        check_near("disk", told.disk_bytes, whole.disk_bytes, 1.1);
        check_near("give", told.tool_give, whole.tool_give, 1.3);
        CHECK(told.place.size() == 1);
        CHECK(told.place.at(0).axes == whole.place.at(0).axes);
        CHECK(told.place.at(0).tools == whole.place.at(0).tools);
        CHECK(told.note == whole.note);
        CHECK(told.body[0].spacing == whole.body[0].spacing);
    }
}

TEST_CASE("a machine is judged by the cells that are asked for where larger ones are counted",
          "[stress]") {
    // A radius of 0.26 cells, which points of larger cells pass by on both sides.
    CountedScene needle("bar", "rubber",
                        "\"shelf\"\nradius = \"0.025 mm\"\ngravity = \"9.81 m/s2\"\n");
    needle.input[0].mesh = box_mesh({0, 0, 0}, {1, 0.002, 0.002});
    for (const double most : {kFew, 3 * kFew, 10 * kFew}) {
        RunCost told;
        CHECK_NOTHROW(told = needle.cost(21, most));
        CHECK(told.place.size() == 1);
        std::string sentence;
        try {
            needle.cost(19, most);
        } catch (const Error& error) {
            sentence = error.what();
        }
        CHECK(sentence.find("radius = 25 um is out of range: it must be 26.31") !=
              std::string::npos);
    }
    // Half a slice is 0.6 cells, or 0.43. What stages after the first say, too.
    const std::string slice = "\"slice\"\nslices = ", again = "\n[[stage]]\nmachine = ";
    for (const auto& [slices, notes] : {std::pair("10", 0), std::pair("14", 1)}) {
        CountedScene ball("sphere", "rubber", slice + slices + again + slice + slices);
        const RunCost whole = ball.cost(24, kAll), told = ball.cost(24, kFew);
        INFO(slices);
        CHECK(whole.counted);
        CHECK_FALSE(told.counted);
        CHECK(int(told.note.size()) == notes);
        CHECK(told.note == whole.note);
        REQUIRE(told.place.size() == 2);
        CHECK(told.place[1].note == whole.place[1].note);
    }
    // What is out of range of a later one is foreseen by them.
    CountedScene later("sphere", "rubber", slice + "2" + again + "\"wring\"\nsqueeze = \"3 mm\"\n");
    CHECK(later.cost(24, kFew).warning.bodies == later.cost(24, kAll).warning.bodies);
    CHECK(later.cost(24, kFew).warning.bodies.size() == 1);
}

TEST_CASE("nothing that is told of a run drops, or leaps, where its cells get too many to count",
          "[stress]") {
    for (const auto& [material, stage] :
         {std::pair("steel_4340", kBend), std::pair("rubber", kFloor)}) {
        CountedScene run("wrench", material, stage);
        const double few = run.cost(6, kAll).mold.active_cells;
        RunCost last = run.cost(3, few);
        bool was_counted = last.counted;
        CHECK(was_counted);
        for (int across = 4; across <= 12; ++across) {
            const RunCost now = run.cost(across, few);
            const double finer = double(across) / (across - 1);
            INFO(material << " " << across << " " << now.mold.active_cells);
            CHECK((was_counted || !now.counted));
            was_counted = now.counted;
            for (const auto& [before, after, most] :
                 {std::tuple(last.mold.active_cells, now.mold.active_cells, 3),
                  std::tuple(last.mold.bytes, now.mold.bytes, 3),
                  std::tuple(last.steps.least, now.steps.least, 1),
                  std::tuple(last.steps.most, now.steps.most, 1),
                  std::tuple(last.seconds.least, now.seconds.least, 4),
                  std::tuple(last.seconds.most, now.seconds.most, 4),
                  std::tuple(last.memory_bytes, now.memory_bytes, 3),
                  std::tuple(last.disk_bytes, now.disk_bytes, 3)}) {
                CHECK(after > 0.95 * before);
                CHECK(after < 1.3 * std::pow(finer, most) * before);
            }
            last = now;
        }
        CHECK_FALSE(last.counted);
    }
}

TEST_CASE("a body is counted in whole layers where it has them, and never in less than one") {
    const auto mold = [](double cells) {
        MoldEstimate one{};
        one.active_cells = cells;
        return one;
    };
    CHECK(coarser_by({mold(900)}, {6}, 1000) == std::vector<double>{1});
    CHECK(coarser_by({mold(8000)}, {6}, 1000)[0] == Approx(2));
    CHECK(coarser_by({mold(8000)}, {7}, 1000)[0] == Approx(7. / 3));
    CHECK(coarser_by({mold(8000)}, {7.5}, 1000)[0] == Approx(2));
    CHECK(coarser_by({mold(8e6)}, {3}, 1000)[0] == Approx(3));
    CHECK(coarser_by({mold(8e6)}, {1}, 1000)[0] == 1);
    // Of several those that have more than their share.
    const std::vector<double> coarser =
        coarser_by({mold(100), mold(7200), mold(100)}, {2, 8, 2}, 1100);
    CHECK(coarser[0] == 1);
    CHECK(coarser[1] == Approx(2));
    CHECK(coarser[2] == 1);
}

TEST_CASE("what larger cells have no room for is counted all the same") {
    // A sheet of a layer; and what a box is too small for.
    CountedScene run("sheet", "rubber", kFloor);
    run.input[0].mesh = box_mesh({0, 0, 0}, {0.4, 0.002, 0.4});
    const RunCost told = run.cost(1, kFew);
    CHECK(told.mold.active_cells == Approx(40000).epsilon(0.02));
    CHECK(told.counted);
    CHECK(told.place.size() == 1);
}

TEST_CASE("steps are told about as many without a mold as with one") {
    for (const char* material : {"rubber", "steel_4340", "aluminium", "glass"}) {
        CountedScene run("bar", material, kFloor);
        const RunCost counted = run.cost(6, kAll);
        RunOptions options;
        options.draw = false;
        const RunCost told = estimate_cost(run.scene, run.input, options);
        INFO(material);
        check_near("steps", told.steps.least, counted.steps.least, 1.4);
    }
}

TEST_CASE("more cells than may be molded are refused before anything is counted") {
    CountedScene run("bar", "rubber", kFloor);
    RunOptions options;
    run.scene.body[0].mold.across = 300;
    for (const auto tell : {+[](const CountedScene&of, const RunOptions&with) {
                                count_cost(of.scene, of.input, with);
                            },
                            +[](const CountedScene&of, const RunOptions&with) {
                                estimate_cost(of.scene, of.input, with);
                            }}) {
        std::string sentence;
        ExitCode code = ExitCode::done;
        try {
            tell(run, options);
        } catch (const Error& error) {
            code = error.code(), sentence = error.what();
        }
        INFO(sentence);
        CHECK(code == ExitCode::resources);
        CHECK(sentence.find("are more than [mold] cell_limit = 50,000,000: use a larger spacing") !=
              std::string::npos);
        CHECK(sentence.find("e+") == std::string::npos);
    }
}

TEST_CASE("a run is refused for what it has to write, not for what it keeps to go on from") {
    RunOptions options;
    options.out = ".";
    options.draw = false;
    RunCost cost;
    cost.disk_bytes = 1e30;
    CHECK_NOTHROW(refuse_excess(cost, options));
    cost.least_disk_bytes = 1e30;
    CHECK_THROWS_AS(refuse_excess(cost, options), Error);
    CountedScene run("bar", "rubber", kBend);
    const RunCost told = run.cost(12, kAll);
    CHECK(told.least_disk_bytes < 0.5 * told.disk_bytes);
    CHECK(told.least_disk_bytes > 0);
}

TEST_CASE("of a fall only the steps are told that come once something can touch") {
    const auto steps = [](const std::string& drop, double seconds, const std::string& more = {}) {
        CountedScene run("wrench", "steel_4340",
                         fmt::format("\"floor\"\ndrop = \"{}\"\ngravity = \"9.81 m/s2\"\n"
                                     "duration = \"{} s\"\n{}",
                                     drop, seconds, more));
        return run.cost(8, kAll).steps.least;
    };
    const double after = 0.01;
    const auto fall = [](double drop) { return std::sqrt(2 * drop / 9.81); };
    const double low = steps("1 mm", fall(1e-3) + after);
    check_near("fall of 1 m", steps("1 m", fall(1) + after), low, 1.02);
    // It flies in a vacuum, by explicit steps.
    CHECK(steps("1 m", fall(1) + after, "medium_density = 1.2") > 30 * low);
    CHECK(steps("1 m", fall(1) + after, "solver = \"energy-stepped\"") > 30 * low);
    CHECK(steps("1 m", 0.9 * fall(1)) == 3);  // a frame takes one
}

TEST_CASE("memory is told of insets too, more of those that are carried through a cut") {
    const test::Scratch scratch;
    const TriMesh ball = make_shape("sphere", {{"division", 60}, {"diameter", 0.015}}).mesh;
    const auto vertices = static_cast<double>(ball.position.size());
    write_obj(scratch.path() / "ball.obj", ball);
    const auto more = [&](const std::string& stage, const std::string& then) {
        CountedScene run("bar", "rubber", stage + then);
        const double none = run.cost(6, kAll).memory_bytes;
        InsetSpec inset;
        inset.file = scratch.path() / "ball.obj";
        inset.material = run.scene.body[0].material;
        run.scene.body[0].inset.push_back(inset);
        return run.cost(6, kAll).memory_bytes - none;
    };
    // A bar with one of 149,786 vertices took 163 MB more where it was cut, 172 in slices.
    const double carried = more("\"cut\"\n", "");
    CHECK(carried / vertices == Approx(163e6 / 149786).epsilon(0.15));
    CHECK(more(kBend, "") < 0.2 * carried);
    // A later stage that molds it anew has its insets from what was carried.
    CHECK(more(kBend, "[[stage]]\nmachine = \"twist\"\nangle = \"5 deg\"\nremold = true\n") ==
          Approx(carried).epsilon(0.1));
}

TEST_CASE("of what may break the memory is told too that it takes as rubble") {
    // Balls of glass that struck a floor and were broken to their particles took 179 and 396 MB of
    // 2391 and 6085 particles; 76 with plane faces and 78 with a boundary for a skin.
    const auto told = [](int across, double roughness, SkinKind kind) {
        CountedScene run("sphere", "glass", kFloor);
        run.scene.skin.roughness = roughness;
        run.scene.skin.kind = kind;
        return run.cost(across, kAll);
    };
    const double rough = SkinSettings().roughness;
    for (const auto& [cost, taken] : {std::pair(told(14, rough, SkinKind::mount), 179e6),
                                      {told(20, rough, SkinKind::mount), 396e6},
                                      {told(14, 0, SkinKind::mount), 76e6},
                                      {told(14, rough, SkinKind::boundary), 78e6}}) {
        INFO("taken " << taken);
        CHECK(cost.memory_bytes < taken);
        CHECK(cost.most_memory_bytes > taken);
        CHECK(cost.most_memory_bytes < 1.5 * taken);
    }
    CountedScene whole("sphere", "rubber", kFloor);
    const RunCost cost = whole.cost(14, kAll);
    CHECK(cost.most_memory_bytes == cost.memory_bytes);
}
