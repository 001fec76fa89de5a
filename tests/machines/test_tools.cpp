// SPDX-License-Identifier: GPL-3.0-or-later
// Where tools stand, what they meet and what they turn about.
#include <fstream>

#include "base/error.h"
#include "geometry/mesh_write.h"
#include "machines/machine.h"
#include "machines/touch.h"
#include "tests/catch.h"
#include "tests/machines/bodies.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

ToolSpec ball() {
    ToolSpec tool;
    tool.name = "ball";
    tool.shape = ToolShape::sphere;
    tool.radius = "height";
    tool.at = {"0", "3*height", "0"};
    return tool;
}

Machine with(const ToolSpec& tool, const Aggregate& body) {
    MachineSpec spec;
    spec.name = "bench";
    spec.tool = {tool};
    return build_machine(spec, {}, place_work_frame(body), body);
}

}  // namespace

TEST_CASE("a mesh stands as a tool with its middle where the machine says, wherever it was drawn") {
    const Scratch scratch;
    const std::filesystem::path file = scratch.path() / "far.obj";
    write_obj(file, box_mesh({Vec3(70, -30, 5), Vec3(78, -26, 6)}));
    ToolSpec tool = ball();
    tool.shape = ToolShape::mesh;
    tool.mesh = file;
    tool.length = "0.4*length";
    const Machine machine = with(tool, bar(0, {1, 2, 3}));
    const Drive drive = drive_at(machine, 0, 1);
    const Box drawn = bounds_of(machine.apparatus.tool[0].shape);
    CHECK((drawn.low + Vec3(0.2, 0.1, 0.025)).norm() < 1e-9);
    CHECK((drawn.high - Vec3(0.2, 0.1, 0.025)).norm() < 1e-9);
    CHECK((drive.world_from_tool[0].translation - Vec3(1, 2.3, 3)).norm() < 1e-9);
    CHECK(distance_to(machine.apparatus.tool[0].shape, Vec3(0, 0.1, 0)).value ==
          Approx(0).margin(1e-3));
}

TEST_CASE("what is odd in a tool's mesh is noted once, each time that its machine is set up") {
    const Scratch scratch;
    ToolSpec tool = ball();
    tool.shape = ToolShape::mesh;
    tool.mesh = scratch.path() / "odd.obj";
    tool.length = "0.4*length";
    write_obj(tool.mesh, box_mesh({Vec3(0, 0, 0), Vec3(8, 4, 1)}));
    CHECK(with(tool, bar(0, {1, 2, 3})).notes.empty());
    std::ofstream(tool.mesh, std::ios::app) << "\nf 1 1 2\nf 2 2 3\n";
    for (int time = 0; time < 2; ++time) {
        const std::vector<std::string> notes = with(tool, bar(0, {1, 2, 3})).notes;
        REQUIRE(notes.size() == 1);
        CHECK(notes[0] == "tool " + tool.name +
                              ": odd.obj: 2 faces of fewer than three different corners were left "
                              "out");
    }
}

TEST_CASE("the axis of a turn is told in the frame of what turns, where that stands") {
    ToolSpec tool = ball();
    tool.axis = {"1", "0", "0"};  // its own z
    tool.motion.turn = "90 deg*t";
    tool.motion.axis = {"1", "0", "0"};
    tool.motion.pivot = {"0", "ball_y + 0.02", "0"};
    MachineSpec spec;
    spec.name = "bench";
    spec.tool = {tool};
    spec.grip = vice_grips();
    spec.grip[1].motion.turn = "10 deg*t";
    const Aggregate body = bar();
    const Machine machine = build_machine(spec, {}, place_work_frame(body), body);
    const auto axes = turn_axes(machine);
    REQUIRE(axes.size() == 3);
    REQUIRE(axes[0]);
    CHECK((axes[0]->along - Vec3::UnitZ()).norm() < 1e-12);
    const Pose& stands = machine.work_from_tool[0];
    CHECK((stands * axes[0]->at - Vec3(0, 0.32, 0)).norm() < 1e-12);
    CHECK_FALSE(axes[1]);
    REQUIRE(axes[2]);
    // A grip's frame lies in the middle of what it holds.
    const Vec3 middle = machine.work_from_grip[1].translation;
    CHECK(middle.x() == Approx(0.45));
    CHECK((axes[2]->at + middle).norm() < 1e-12);
}

TEST_CASE("a tool passes through the gap that a cut has opened, and meets what is beside it") {
    Aggregate body = test::make_block(20, 8, 8, 0.0125, Material{});
    test::sever_plane(body, Vec3(0.12, 0, 0), Vec3::UnitX());
    for (std::size_t p = 0; p < body.particle_count(); ++p) {
        if (body.particle_reference.at(p).x() > 0.12) body.particle_position.add(p, {0.4, 0, 0});
    }
    ToolSpec tool = ball();
    tool.touch = {"0", "-1", "0"};
    tool.radius = "0.02";
    const auto refusal = [&](const char* x) -> std::string {
        tool.at[0] = x;  // 0.2 m from the middle of what there was
        try {
            with(tool, body);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    CHECK(refusal("0").find("can never touch the work-piece") != std::string::npos);
    CHECK(refusal("0.2").find("can never touch the work-piece") != std::string::npos);
    CHECK(refusal("-0.1") == "");
    CHECK(refusal("0.325") == "");
}

TEST_CASE("what goes by nothing but where a machine stops is no constant") {
    const Timed half({"0.5*stop"}, {{"length", 1}}, Quantity::number);
    CHECK(half.varies());
    CHECK(half.at(0.3) == 0.5);
    CHECK(half.at(0.3, 0.2) == 0.1);
    CHECK_FALSE(Timed({"0.5*length"}, {{"length", 1}}, Quantity::number).varies());
}

TEST_CASE("a tool beside the surface is not said to be inside of cells that are filled in part") {
    const Aggregate body = test::make_shape([](const Vec3& x) { return x.norm() - 0.32; },
                                            Vec3::Constant(-0.4), Vec3i(8, 8, 8), 0.1);
    std::size_t looked = 0;
    for (std::size_t c = 0; c < body.cell_fill.size(); ++c) {
        if (body.cell_fill[c] > 0.2) continue;
        Vec3 middle = Vec3::Zero();
        for (const ParticleId p : body.lattice.cell_corners(static_cast<CellId>(c))) {
            middle += body.particle_position.at(p) / 8;
        }
        ToolSpec tool = ball();
        tool.radius = "0.004";
        for (int d = 0; d < 3; ++d) tool.at[d] = fmt::format("{:.17g}", middle[d]);
        const Machine machine = with(tool, body);
        CHECK(machine.notes == std::vector<std::string>());
        ++looked;
    }
    CHECK(looked > 0);
}
