// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/parted_grips.h"

#include "pipeline/start_doubts.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

// Of 12 cells of 0.1 m along x, whole or in two pieces, which bear the mass of 3.5 and 8.5 of them.
Aggregate block(bool parted) {
    Aggregate matter = test::make_block(12, 3, 3, 0.1, Material{});
    if (parted) test::sever_plane(matter, Vec3(-0.2001, 0, 0), Vec3::UnitX());
    return matter;
}

GripSpec grip(const char* name, const char* from, const char* to) {
    GripSpec grip;
    grip.name = name;
    grip.from = {from, "-height", "-width"};
    grip.to = {to, "height", "width"};
    return grip;
}

StageSpec twist() {
    StageSpec stage;
    stage.name = "twist";
    stage.machine.name = "twist";
    stage.machine.grip = {grip("hold", "-length", "-0.4*length"),
                          grip("turn", "0.4*length", "length")};
    stage.machine.grip[1].motion.turn = "t";
    return stage;
}

std::string told_of(const StageSpec& stage, const Aggregate& matter) {
    return parted_grips(stage, build_machine(stage.machine, {}, place_work_frame(matter), matter),
                        matter);
}

}  // namespace

TEST_CASE("grips that turn pieces which nothing joins are told of, with what each holds") {
    const std::string told = told_of(twist(), block(true));
    CAPTURE(told);
    CHECK(told.find("hold: piece 1, with 29 % of the mass") != std::string::npos);
    CHECK(told.find("turn: piece 2, with 71 % of the mass") != std::string::npos);
    CHECK(told.find("deform none") != std::string::npos);
    CHECK(told.find("Pieces that touch") == std::string::npos);
    StageSpec touching = twist();
    touching.sim.self_contact = true;
    CHECK(told_of(touching, block(true))
              .find("Pieces that touch push and rub on each other, "
                    "which joins nothing") != std::string::npos);
}

TEST_CASE("grips that deform a piece, or move together, or let a blade part it are not told of") {
    CHECK(told_of(twist(), block(false)).empty());
    StageSpec together = twist();
    together.machine.grip[0].motion.turn = "t";
    CHECK(told_of(together, block(true)).empty());
    StageSpec third = twist();  // the piece that turns is also held beside the cut
    third.machine.grip.push_back(grip("other", "-0.05*length", "0.05*length"));
    CHECK(told_of(third, block(true)).empty());
    StageSpec cuts = twist();
    BladeSpec& blade = cuts.machine.blade.emplace_back();
    blade.name = "blade";
    blade.edge = {{"0", "height", "-width"}, {"0", "height", "width"}};
    blade.motion.move = {"0", "-2*height*t", "0"};
    CHECK(told_of(cuts, block(true)).empty());
}

TEST_CASE("grips on pieces that the mesh itself does not join are told of before the run") {
    SceneSpec scene;
    scene.body.emplace_back();
    scene.stage.push_back(twist());
    const Aggregate parted = block(true), whole = block(false);
    const auto doubts = [&](const Aggregate& matter, double coarser) {
        return doubts_of_start(scene, {{"bar", &matter, {}, coarser}});
    };
    REQUIRE(doubts(parted, 1).size() == 1);
    CHECK(doubts(parted, 1)[0].find("twist: its grips hold separate pieces") == 0);
    CHECK(doubts(parted, 2).empty());  // what stands for finer cells may part at a neck
    CHECK(doubts(whole, 1).empty());
}
