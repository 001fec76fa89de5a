// SPDX-License-Identifier: GPL-3.0-or-later
// What a run is told to take: from the least to the most. That a run comes to lie in between is
// tried by its counts alone, in tests/app/check_test.cpp.
#include "pipeline/time_cost.h"

#include <limits>

#include "base/parallel.h"
#include "geometry/make_shape.h"
#include "pipeline/cost.h"
#include "tests/catch.h"

using namespace swage;

namespace {

// A bar and a stage of a second, not drawn.
struct Work {
    InputMesh input;
    SceneSpec scene;

    explicit Work(Solver solver, bool has_tools = false) {
        input.mesh = make_shape("bar", {}).mesh;
        scene.body.resize(1);
        scene.body[0].mold.across = 6;
        scene.stage.resize(1);
        scene.stage[0].duration = 1;
        scene.stage[0].sim.solver = solver;
        if (has_tools) scene.stage[0].machine.tool.resize(1);
    }
    CostRange seconds() const {
        RunOptions options;
        options.draw = false;
        return estimate_cost(scene, std::vector(scene.body.size(), input), options).seconds;
    }
};

constexpr Solver kSolvers[] = {Solver::quasistatic, Solver::explicit_steps, Solver::euler,
                               Solver::energy_stepped, Solver::implicit_steps};

}  // namespace

TEST_CASE("springs that flow may take longer than cells that do, and elastic ones no longer") {
    const auto most = [](Mechanics mechanics, double yield_stress) {
        Work work(Solver::explicit_steps);
        work.scene.body[0].material.mechanics = mechanics;
        work.scene.body[0].material.yield_stress = yield_stress;
        return work.seconds().most;
    };
    const double never = std::numeric_limits<double>::infinity();
    CHECK(most(Mechanics::springs, 1e6) > 2 * most(Mechanics::cells, 1e6));
    CHECK(most(Mechanics::springs, never) == most(Mechanics::cells, never));
}

TEST_CASE("more cells, more frames or a longer time are never told to take less") {
    for (const Solver solver : kSolvers) {
        for (const bool tools : {false, true}) {
            CostRange last;
            for (int across = 2; across < 14; ++across) {
                Work work(solver, tools);
                work.scene.body[0].mold.across = across;
                const CostRange now = work.seconds();
                INFO(name_of(solver) << tools << across);
                CHECK(now.least > last.least);
                CHECK(now.most > last.most);
                CHECK(now.least < now.most);
                last = now;
            }
            Work longer(solver, tools);
            const CostRange before = longer.seconds();
            longer.scene.stage[0].frames *= 2;
            longer.scene.stage[0].duration *= 2;
            CHECK(longer.seconds().least > before.least);
            CHECK(longer.seconds().most > before.most);
        }
    }
}

TEST_CASE("what may happen on top makes the most that is told more, and the least no less") {
    for (const Solver solver : {Solver::quasistatic, Solver::explicit_steps}) {
        for (const bool tools : {false, true}) {
            INFO(name_of(solver) << tools);
            const Work plain(solver, tools);
            const auto more = [&](auto change) {
                Work work = plain;
                change(work.scene);
                CHECK(work.seconds().most > plain.seconds().most);
                CHECK(work.seconds().least >= plain.seconds().least);
            };
            more([](SceneSpec& scene) { scene.body[0].material.strength = 1e6; });
            if (solver == Solver::quasistatic) continue;
            more([](SceneSpec& scene) { scene.stage[0].sim.self_contact = true; });
            more([](SceneSpec& scene) { scene.body.push_back(scene.body[0]); });
            more([](SceneSpec& scene) { scene.stage[0].sim.medium_density = 1; });
            more([](SceneSpec& scene) {
                scene.body[0].material.yield_stress = 1e6;
                scene.body[0].start.velocity = {0, -30, 0};
            });
        }
    }
}

TEST_CASE("a time that nothing can change much is told as one, what may go to pieces is not") {
    Work work(Solver::explicit_steps);
    CHECK(work.seconds().is_narrow());
    work.scene.body[0].material.strength = 1e6;
    CHECK(work.seconds().most > 20 * work.seconds().least);
    // What strikes a tool harder than it bears does go to pieces.
    Work struck(Solver::explicit_steps, true);
    struck.scene.body[0].material.strength = 1e6;
    const double least = struck.seconds().least;
    struck.scene.body[0].start.velocity = {0, -1000, 0};
    CHECK(struck.seconds().least > 2 * least);
}

TEST_CASE(
    "the least that is told is what a body takes that strikes nothing, the most what it may") {
    const auto bar = [](const Vec3& velocity, double yield_stress, double strength) {
        Work work(Solver::explicit_steps, true);
        work.scene.body[0].material.yield_stress = yield_stress;
        work.scene.body[0].material.strength = strength;
        work.scene.body[0].start.velocity = velocity;
        return work.seconds();
    };
    const double never = std::numeric_limits<double>::infinity();
    for (const Vec3& away : {Vec3(0, 1000, 0), Vec3(1000, 0, 0)}) {
        CHECK(bar(away, 1e6, never).least == Approx(bar(Vec3::Zero(), 1e6, never).least));
        CHECK(bar(away, never, 1e6).least == Approx(bar(Vec3::Zero(), never, 1e6).least));
    }
    // How flat flow strikes cells is not known either.
    const Vec3 down(0, -1000, 0);
    CHECK(bar(down, 1e6, never).least == Approx(bar(Vec3::Zero(), 1e6, never).least));
    CHECK(bar(down, 1e6, never).most > 10 * bar(Vec3::Zero(), 1e6, never).least);
    // Who falls no farther than a drop is no faster.
    Work falls(Solver::explicit_steps, true);
    falls.scene.stage[0].duration = 100;
    falls.scene.stage[0].machine.upright = true;
    falls.scene.stage[0].sim.gravity = {0, -9.81, 0};
    falls.scene.body[0].material.yield_stress = 1e6;
    const double any = falls.seconds().most;
    falls.scene.stage[0].parameter["drop"] = 0.01;
    CHECK(falls.seconds().most < 0.5 * any);
}

TEST_CASE("the same scene is told the same, and never longer with another thread") {
    const int before = thread_count();
    for (const Solver solver : kSolvers) {
        const Work work(solver, true);
        set_thread_count(1);
        const CostRange one = work.seconds(), again = work.seconds();
        CHECK(one.least == again.least);
        CHECK(one.most == again.most);
        set_thread_count(2);
        const CostRange two = work.seconds();
        CHECK(two.least <= one.least);
        CHECK(two.most <= one.most);
    }
    set_thread_count(before);
}

TEST_CASE(
    "thin and incompressible plates that may bend are told more at the most than stout ones") {
    const auto iterations = [](const char* shape, double poisson_ratio, bool tools) {
        Work work(Solver::quasistatic, tools);
        work.input.mesh = make_shape(shape, {}).mesh;
        work.scene.body[0].mold.across = 1;
        work.scene.body[0].material.poisson_ratio = poisson_ratio;
        if (!tools) work.scene.stage[0].sim.gravity = {0, -9.81, 0};
        RunOptions options;
        options.draw = false;
        return estimate_cost(work.scene, {work.input}, options).steps;
    };
    for (const bool tools : {false, true}) {
        INFO(tools);
        const CostRange bar = iterations("bar", 0.3, tools),
                        sheet = iterations("sheet", 0.3, tools);
        CHECK(sheet.most > 1.8 * bar.most);  // 50 times as long as thick, not 10
        CHECK(sheet.least == bar.least);
        // Pressure waves' modulus is 13 times as much.
        CHECK(iterations("bar", 0.49, tools).most > 2 * bar.most);
        CHECK(iterations("bar", 0.3, tools).most == bar.most);
    }
}

TEST_CASE(
    "what blades cut is told the few iterations that it takes where nothing else strains it") {
    const auto told = [](auto change) {
        Work work(Solver::quasistatic);
        work.scene.stage[0].machine.blade.resize(1);
        change(work.scene);
        RunOptions options;
        options.draw = false;
        const CostRange steps = estimate_cost(work.scene, {work.input}, options).steps;
        return steps.times(1.0 / frame_count(work.scene));
    };
    const CostRange cut = told([](SceneSpec&) {});
    CHECK(cut.least > 5);
    CHECK(cut.most < 50);
    // Grips that draw away what is cut change nothing; what turns, presses, pulls or breaks may.
    const CostRange parted = told([](SceneSpec& scene) {
        GripSpec grip;
        grip.motion.move[0] = "t";
        scene.stage[0].machine.grip.push_back(grip);
    });
    CHECK(parted.most == cut.most);
    const auto may_take_more = [&](auto change) {
        const CostRange more = told(change);
        CHECK(more.most > 20 * cut.most);
        CHECK(more.least <= cut.least);
    };
    may_take_more([](SceneSpec& scene) {
        GripSpec grip;
        grip.motion.turn = "t";
        scene.stage[0].machine.grip.push_back(grip);
    });
    may_take_more([](SceneSpec& scene) { scene.stage[0].machine.tool.resize(1); });
    may_take_more([](SceneSpec& scene) { scene.stage[0].machine.load.resize(1); });
    may_take_more([](SceneSpec& scene) { scene.stage[0].sim.gravity = {0, -9.81, 0}; });
    may_take_more([](SceneSpec& scene) { scene.stage[0].sim.self_contact = true; });
    may_take_more([](SceneSpec& scene) { scene.body[0].material.strength = 1e6; });
    // What was strained before goes on to be.
    const CostRange later = told([](SceneSpec& scene) {
        scene.stage.insert(scene.stage.begin(), scene.stage.front());
        scene.stage[0].machine.blade.clear();
        scene.stage[0].machine.tool.resize(1);
    });
    CHECK(later.most > 20 * cut.most);
}

TEST_CASE("passes are told to take their time, all of them twice that of the stills alone") {
    RenderSettings render;
    render.width = 3840;
    render.height = 2160;
    const double stills = drawing_time(render, 10);
    const auto with = [&](std::vector<PicturePass> passes) {
        render.passes = std::move(passes);
        return drawing_time(render, 10);
    };
    using enum PicturePass;
    double longest = 0;
    for (const PicturePass one : {depth, matte, normal, motion, beauty, piece}) {
        CHECK(with({one}) > 1.1 * stills);
        longest = std::max(longest, with({one}));
    }
    const double all = with({depth, matte, normal, motion, beauty, piece});
    CHECK(all > longest);
    CHECK(all / stills == Approx(8.4 / 2.5).epsilon(0.15));
}
