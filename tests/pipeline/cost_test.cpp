// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/cost.h"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/box_mesh.h"
#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "pipeline/checkpoint.h"
#include "pipeline/disk_cost.h"
#include "skin/boundary.h"
#include "skin/divided_mesh.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

RunCost cost_of(const std::string& shape, const std::map<std::string, double>& size) {
    InputMesh input;
    input.mesh = make_shape(shape, size).mesh;
    SceneSpec scene;
    scene.body.resize(1);
    scene.body[0].mold.across = 6;
    return estimate_cost(scene, {input}, {});
}

// A bar and one stage, not drawn.
struct BarScene {
    InputMesh input;
    SceneSpec scene;

    explicit BarScene(int across) {
        input.mesh = make_shape("bar", {}).mesh;
        scene.body.resize(1);
        scene.body[0].mold.across = across;
        scene.stage.resize(1);
        scene.stage[0].duration = 1;
    }
    RunCost cost() const {
        RunOptions options;
        options.draw = false;
        return estimate_cost(scene, std::vector(scene.body.size(), input), options);
    }
};

}  // namespace

TEST_CASE("a body's thin parts are told in cells, and a solid one has none") {
    const RunCost tube = cost_of("tube", {{"length", 0.3}, {"diameter", 0.06}, {"wall", 0.005}});
    CHECK(tube.work_piece().has_thin_parts());
    CHECK(tube.work_piece().thickness == Approx(0.5).epsilon(0.05));  // cells of 1 cm
    for (const char* solid : {"bar", "rod", "sphere", "sheet"}) {
        const RunCost cost = cost_of(solid, {});
        INFO(solid);
        CHECK_FALSE(cost.work_piece().has_thin_parts());
        CHECK(cost.work_piece().thickness == Approx(6));
    }
}

TEST_CASE("a side that spacing does not divide is told in layers as it lies in them") {
    BarScene bar(6);
    const double side = box_of(bar.input.mesh.position).size().minCoeff();
    MoldSettings& mold = bar.scene.body[0].mold;
    mold.across.reset();
    const auto body = [&](double layers) {
        mold.spacing = side / layers;
        return bar.cost().work_piece();
    };
    for (const double layers : {4.2, 4.55, 4.8, 1.3}) {
        const BodyCost told = body(layers);
        INFO(layers);
        CHECK(told.across == Approx(layers));
        CHECK(told.thickness == Approx(layers));
        CHECK_FALSE(told.has_thin_parts());
        CHECK(told.whole_layers() == (layers < 4.5 ? std::floor(layers) : 5));
        // What is told to be better has whole ones.
        CHECK(body(told.whole_layers()).whole_layers() == 0);
        CHECK(body(told.whole_layers()).across == told.whole_layers());
    }
    CHECK(body(4.2).outermost_fill() == Approx(0.6));
    CHECK(body(1.3).outermost_fill() == Approx(0.65));
    mold.kind = MoldKind::block;
    mold.spacing = side / 4.2;
    CHECK(bar.cost().work_piece().across == 5);
    mold = {};
    mold.across = 7;
    CHECK(bar.cost().work_piece().whole_layers() == 0);
}

TEST_CASE("what a boundary's meshes take is told by its cells, not by the mesh that came") {
    for (const char* shape : {"bar", "sphere"}) {
        InputMesh input;
        input.mesh = make_shape(shape, {}).mesh;
        SceneSpec scene;
        scene.body.resize(1);
        scene.body[0].mold.across = 8;
        scene.skin.kind = SkinKind::boundary;
        scene.stage.resize(1);
        scene.stage[0].frames = 100;
        RunOptions options;
        options.draw = false;
        const double once = estimate_cost(scene, {input}, options).disk_bytes;
        scene.output.meshes_per_frame = true;
        const double each = estimate_cost(scene, {input}, options).disk_bytes;
        const TriMesh skin =
            boundary_skin(mold(input.mesh, scene.body[0].material, scene.body[0].mold)).mesh;
        const double vertices = (each - once) / (100 * 400);
        INFO(shape << ": " << vertices << " of " << skin.position.size());
        CHECK(vertices > 0.7 * static_cast<double>(skin.position.size()));
        CHECK(vertices < 2 * static_cast<double>(skin.position.size()));
    }
}

TEST_CASE("what a mesh of few triangles takes is told as it is once it is divided") {
    const auto disk = [](const TriMesh& mesh, std::optional<double> longest) {
        BarScene bar(6);
        bar.input.mesh = mesh;
        bar.scene.skin.longest_edge = longest;
        bar.scene.output.meshes_per_frame = true;
        bar.scene.stage[0].frames = 600;  // beside which matter that is kept is little
        return bar.cost().disk_bytes;
    };
    const TriMesh coarse = box_mesh({0, 0, 0}, {0.2, 0.02, 0.02});
    const double longest = GENERATE(4., kLongestSkinEdge, 0.4);
    const TriMesh divided = divide_edges(coarse, longest * 0.02 / 6);
    // Edges are halved, so that how fine they become goes up in steps.
    const double off = longest == kLongestSkinEdge ? 0.2 : 0.45;
    CHECK(disk(coarse, longest) == Approx(disk(divided, longest)).epsilon(off));
    CHECK(disk(divided, longest) == disk(divided, std::nullopt));
    CHECK(disk(coarse, std::nullopt) < 0.3 * disk(coarse, longest));
}

TEST_CASE("what a run writes is told with tools, textures and skins that are stored anew") {
    BarScene bar(6);
    StageSpec& stage = bar.scene.stage[0];
    const double plain = bar.cost().disk_bytes;
    const double skin = 130 * static_cast<double>(bar.input.mesh.position.size());
    stage.machine.tool.resize(2);
    const double pressed = bar.cost().disk_bytes;
    CHECK(pressed > plain + 146e3);  // two plates
    bar.input.mesh.material.resize(1);
    bar.input.mesh.material[0].embedded_texture = std::make_shared<std::string>(1000, ' ');
    // Two more within the stage: what is kept of it, while the next is written.
    CHECK(bar.cost().disk_bytes - pressed == Approx(4000));
    stage.machine.blade.resize(1);
    CHECK(bar.cost().disk_bytes > pressed + stage.frames * skin);
    stage.machine.blade.clear();
    bar.scene.body[0].material.strength = 1e6;
    const double rough = bar.cost().disk_bytes;
    CHECK(rough > pressed + stage.frames * skin);
    bar.scene.skin.roughness = 0;
    CHECK(rough > bar.cost().disk_bytes + stage.frames * skin);
}

TEST_CASE("what a run keeps to go on from is told, and counts where nothing else is as large") {
    BarScene bar(9);
    const Scratch scratch;
    for (const SkinKind skin : {SkinKind::mount, SkinKind::boundary}) {
        for (const bool flows : {false, true}) {
            bar.scene.skin.kind = skin;
            BodySpec& body = bar.scene.body[0];
            body.material.yield_stress = flows ? 1e5 : std::numeric_limits<double>::infinity();
            Reached reached;
            reached.bodies.push_back(make_work_piece(bar.input, body, bar.scene.skin));
            reached.skin = {0};
            WorkPiece& piece = reached.bodies[0];
            const double cells = static_cast<double>(piece.matter.cell_fill.size());
            const DiskShare of = {1,
                                  0,
                                  cells,
                                  static_cast<double>(piece.matter.particle_count()),
                                  static_cast<double>(piece.matter.bytes()),
                                  static_cast<double>(piece.skin.position.size())};
            if (flows) piece.matter.cell_history.assign(piece.matter.cell_fill.size());
            write_checkpoint(scratch.path() / "checkpoint.bin", {"key"}, reached);
            const auto size =
                static_cast<double>(std::filesystem::file_size(scratch.path() / "checkpoint.bin"));
            const double told = checkpoint_bytes(bar.scene, {bar.input}, of);
            INFO(int(skin) << " " << flows << ": " << told << " " << size);
            CHECK(told > size);
            CHECK(told < 1.5 * size);
        }
    }
    // Of each stage, unless none is to be kept: then of the last.
    const auto disk = [&](std::size_t stages, bool keep) {
        bar.scene.stage.resize(stages);
        bar.scene.output.keep_stages = keep;
        return bar.cost().disk_bytes;
    };
    const double stage = disk(4, false) - disk(3, false),
                 kept = disk(2, false) - disk(1, false) - stage;
    CHECK(kept > 1e6);
    CHECK(disk(3, false) - disk(2, false) == Approx(stage));
    for (const std::size_t stages : {2, 3, 9}) {
        CHECK(disk(stages, true) - disk(stages - 1, true) == Approx(stage + kept));
    }
}

TEST_CASE("what a machine's way over very many frames takes is told") {
    BarScene bar(3);
    bar.scene.stage[0].machine.grip.resize(2);
    bar.scene.stage.resize(2);  // the other's way follows when that is gone
    const auto memory = [&](int frames) {
        bar.scene.stage[0].frames = frames;
        return bar.cost().memory_bytes;
    };
    // 395 MB were measured at a million frames, the program's and the matter's among them.
    CHECK(memory(1'000'000) - memory(1) == Approx(315e6).epsilon(0.3));
    CHECK(memory(3'000'000) - memory(1) == Approx(3 * 315e6).epsilon(0.3));
    CHECK(memory(1'000'000'000) > 2e11);
    CHECK(memory(100) - memory(1) < 5e6);
}

TEST_CASE("a step that damps, or of matter that yields, is told to take longer") {
    const auto seconds_a_step = [&](double damping_ratio, double yield_stress) {
        BarScene bar(6);
        bar.scene.body[0].material.damping_ratio = damping_ratio;
        bar.scene.body[0].material.yield_stress = yield_stress;
        bar.scene.stage[0].sim.solver = Solver::explicit_steps;
        bar.scene.stage[0].duration = 10;
        return bar.cost().seconds.middle() / bar.cost().steps.middle();
    };
    const double never = std::numeric_limits<double>::infinity();
    const double plain = seconds_a_step(0, never), damped = seconds_a_step(0.02, never);
    CHECK(damped > 1.5 * plain);
    CHECK(seconds_a_step(0, 1e6) > 1.2 * plain);
    CHECK(seconds_a_step(0.02, 1e6) > 1.2 * damped);
}

TEST_CASE("a solver that takes many times the steps of explicit ones is said to") {
    BarScene bar(4);
    bar.scene.stage.resize(2);
    for (StageSpec& stage : bar.scene.stage) {
        stage.duration = 0.1;
        stage.sim.solver = Solver::explicit_steps;
    }
    CHECK(bar.cost().note.empty());
    bar.scene.body[0].material.damping_ratio = 0;
    const double few = bar.cost().steps.middle();
    for (StageSpec& stage : bar.scene.stage) stage.sim.solver = Solver::energy_stepped;
    const RunCost cost = bar.cost();
    REQUIRE(cost.note.size() == 1);
    CHECK(cost.note[0].find(fmt::format("solver = \"energy-stepped\" takes about {:.0f} times as "
                                        "many steps as \"explicit\"",
                                        cost.steps.middle() / few)) != std::string::npos);
    bar.scene.body[0].material.damping_ratio = 0.05;  // it comes to rest
    CHECK(bar.cost().note.empty());
    CHECK(bar.cost().steps.most < 0.25 * cost.steps.most);
    for (StageSpec& stage : bar.scene.stage) stage.sim.solver = Solver::euler;
    CHECK(bar.cost().note.size() == 1);
    bar.scene.body[0].material.damping_ratio = 0.5;
    CHECK(bar.cost().note.empty());
}

TEST_CASE("implicit steps are told by the frame, each taking hundreds of times an explicit one") {
    BarScene bar(6);
    bar.scene.stage[0].frames = 10;
    bar.scene.stage[0].duration = 1;
    bar.scene.stage[0].sim.solver = Solver::implicit_steps;
    const RunCost implicit = bar.cost();
    bar.scene.stage[0].sim.solver = Solver::explicit_steps;
    const RunCost explicit_one = bar.cost();
    CHECK(implicit.steps.least == 40);
    CHECK(implicit.seconds.middle() / implicit.steps.middle() >
          50 * explicit_one.seconds.middle() / explicit_one.steps.middle());
}

TEST_CASE("a boundary's meshes are told by each body's own cells") {
    BarScene bar(12);
    bar.scene.skin.kind = SkinKind::boundary;
    bar.scene.stage[0].frames = 2000;  // beside which what is kept is little
    bar.scene.output.meshes_per_frame = true;
    const double fine = bar.cost().disk_bytes;
    bar.scene.body[0].mold.across = 3;
    const double coarse = bar.cost().disk_bytes;
    bar.scene.body.push_back(bar.scene.body[0]);
    bar.scene.body[1].mold.across = 12;
    CHECK(bar.cost().disk_bytes == Approx(fine + coarse).epsilon(0.01));
}

TEST_CASE("what the softest tool gives way by is told in cells") {
    BarScene bar(6);
    StageSpec& stage = bar.scene.stage[0];
    const auto give = [&] { return bar.cost().tool_give; };
    CHECK(give() == 0);
    stage.machine.tool.resize(2);
    for (ToolSpec& tool : stage.machine.tool) tool.contact_stiffness = 20;
    CHECK(give() == Approx(0.05));
    stage.machine.tool[1].contact_stiffness = 0;
    CHECK(give() == Approx(0.5));
    stage.sim.contact_stiffness = 10;
    CHECK(give() == Approx(0.1));
    stage.sim.contact_stiffness = 0;
    stage.machine.tool.resize(1);
    stage.machine.tool[0].contact_stiffness = 20;
    stage.sim.solver = Solver::explicit_steps;  // which no tool's word shortens
    CHECK(give() == Approx(0.5));
}

TEST_CASE("a body that makes all steps far shorter than others need is told, with the others") {
    SceneSpec scene;
    scene.body.resize(3);
    scene.stage.resize(1);
    scene.body[0].name = "foam", scene.body[1].name = "ball", scene.body[2].name = "gear";
    const auto note_of = [&](double stiffer, Solver solver) {
        scene.stage[0].sim.solver = solver;
        CountedMatter counted;
        counted.coarser.assign(3, 1.0);
        std::vector<Aggregate>& matter = counted.matter;
        MoldSettings settings;
        settings.across = 3;
        for (std::size_t b = 0; b < 3; ++b) {
            const double modulus[] = {1e6, stiffer * 1e6, 0.5 * stiffer * 1e6};
            const Material material{.young_modulus = modulus[b], .density = 1000};
            matter.push_back(mold(make_shape("bar", {}).mesh, material, settings));
        }
        return step_note(scene, counted);
    };
    const std::string note = note_of(900, Solver::explicit_steps);
    CHECK(note.find("all steps are as short as ball needs, others would allow longer ones: foam 30 "
                    "times; ") == 0);
    CHECK(note_of(9, Solver::explicit_steps).empty());
    CHECK(note_of(900, Solver::implicit_steps).empty());
}

TEST_CASE("many bodies that would allow longer steps are told together") {
    SceneSpec scene;
    scene.stage.resize(1);
    scene.stage[0].sim.solver = Solver::explicit_steps;
    CountedMatter counted;
    MoldSettings settings;
    settings.across = 3;
    const auto note_of = [&](const std::vector<double>& softer) {
        scene.body.assign(softer.size(), BodySpec{});
        counted.matter.clear();
        counted.coarser.assign(softer.size(), 1.0);
        for (std::size_t b = 0; b < softer.size(); ++b) {
            scene.body[b].name = fmt::format("body-{}", b + 1);
            const Material material{.young_modulus = 1e9 / (softer[b] * softer[b]),
                                    .density = 1000};
            counted.matter.push_back(mold(make_shape("bar", {}).mesh, material, settings));
        }
        return step_note(scene, counted);
    };
    const std::string
        of = "all steps are as short as body-3 needs, others would allow longer ones: ",
        so = "; larger cells";
    CHECK(note_of({21, 21, 1, 21, 21, 21})
              .find(of + "body-1, body-2, body-4 to body-6 21 times" + so) == 0);
    CHECK(note_of({21, 21, 1, 30, 21, 21})
              .find(of + "body-1, body-2, body-5, body-6 21 times; body-4 30 times" + so) == 0);
    // So many different ones that they would fill a page.
    CHECK(note_of({21, 22, 1, 23, 24, 25, 26}).find(of + "6 bodies 21 to 26 times" + so) == 0);
}

TEST_CASE("what is odd about a mesh, and what is too coarse to break as it should, is told") {
    BarScene bar(6);
    bar.scene.body[0].material.strength = 1e4;
    bar.scene.body[0].material.toughness = 1e-3;
    bar.input.finding = {"the bar is odd"};
    const RunCost cost = bar.cost();
    REQUIRE(cost.warning.strength.size() == 1);
    CHECK(cost_json(cost).at("warnings") ==
          Json::array({"the bar is odd", cost.warning.strength[0]}));
}

TEST_CASE("what a process has taken already is not free for its run") {
    double taken = 0;
    std::ifstream("/proc/self/statm") >> taken;
    taken *= static_cast<double>(::sysconf(_SC_PAGESIZE));
    constexpr double kRoom = 1e9;
    rlimit before = {};
    ::getrlimit(RLIMIT_AS, &before);
    set_thread_count(1);
    const rlimit limit = {static_cast<rlim_t>(taken + kRoom), before.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_AS, &limit) == 0);
    RunOptions options;
    options.out = ".";
    RunCost cost;
    cost.memory_bytes = kRoom + 0.5 * taken;
    CHECK_THROWS_AS(refuse_excess(cost, options), Error);
    cost.memory_bytes = 0.1 * kRoom;
    CHECK_NOTHROW(refuse_excess(cost, options));
    // Nor are addresses that libraries for drawing and stacks of threads will take.
    cost.memory_bytes = 0.6 * kRoom;
    CHECK_THROWS_AS(refuse_excess(cost, options), Error);
    options.draw = false;
    CHECK_NOTHROW(refuse_excess(cost, options));
    set_thread_count(16);
    CHECK_THROWS_AS(refuse_excess(cost, options), Error);
    set_thread_count(0);
    ::setrlimit(RLIMIT_AS, &before);
}

TEST_CASE("springs are told the same steps, whatever Poisson's ratio their material has") {
    BarScene bar(6);
    bar.scene.stage[0].sim.solver = Solver::explicit_steps;
    Material& material = bar.scene.body[0].material;
    const auto steps = [&](Mechanics mechanics, double poisson_ratio) {
        material.mechanics = mechanics, material.poisson_ratio = poisson_ratio;
        return bar.cost().steps.least;
    };
    CHECK(steps(Mechanics::springs, 0.49) == steps(Mechanics::springs, 0.25));
    CHECK(steps(Mechanics::springs, 0.49) == steps(Mechanics::cells, 0.25));
    CHECK(steps(Mechanics::cells, 0.49) > 3 * steps(Mechanics::cells, 0.25));
}

TEST_CASE("a run that lacks memory is told to take less of what takes it") {
    RunOptions options;
    options.out = ".";
    const auto advice = [&](const BarScene& bar, bool draws) {
        options.draw = draws;
        RunCost cost = estimate_cost(bar.scene, {bar.input}, options);
        cost.memory_bytes = 1e30;
        try {
            refuse_excess(cost, options);
        } catch (const Error& error) {
            const std::string said = error.what();
            const std::size_t from = said.find(" is free: "), to = said.find(" needs less (");
            REQUIRE(to != std::string::npos);
            return said.substr(from + 10, to - from - 10);
        }
        return std::string("nothing");
    };
    CHECK(advice(BarScene(40), true) == "a larger [mold] spacing");
    BarScene bar(2);
    bar.scene.render.width = bar.scene.render.height = 16384;
    CHECK(advice(bar, true) == "a smaller [render] size");
    CHECK(advice(bar, false) == "a larger [mold] spacing");
    bar.scene.stage[0].frames = 100'000'000;
    CHECK(advice(bar, false) == "fewer frames");
    BarScene ball(2);
    ball.input.mesh = make_shape("sphere", {{"division", 200}}).mesh;
    CHECK(advice(ball, false) == "a mesh of fewer triangles");
}

// Of a ball of glass that was broken to its particles, 613 of them, on its rough faces.
TEST_CASE("the most disk that is told holds the meshes of a body in crumbs, the least does not") {
    InputMesh ball;
    ball.mesh = make_shape("sphere", {}).mesh;
    SceneSpec scene;
    scene.body.resize(1);
    scene.body[0].mold.across = 8;
    scene.body[0].material.strength = 1e6;
    scene.stage.resize(1);
    scene.stage[0].frames = 12;
    scene.stage[0].sim.solver = Solver::explicit_steps;
    scene.output.meshes_per_frame = true;
    RunOptions options;
    options.draw = false;
    const RunCost told = estimate_cost(scene, {ball}, options);
    CHECK(told.disk_bytes > 134e6);  // taken
    CHECK(told.least_disk_bytes < 10e6);
    scene.skin.roughness = 0;
    const double smooth = estimate_cost(scene, {ball}, options).disk_bytes;
    CHECK(smooth > 60e6);
    CHECK(smooth < 0.7 * told.disk_bytes);
}
