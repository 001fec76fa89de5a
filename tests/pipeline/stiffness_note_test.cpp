// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stiffness_note.h"

#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;

TEST_CASE("a stiffness that steps do not leave is told, with the step_safety that does") {
    const Material material{.young_modulus = 5e6, .poisson_ratio = 0, .density = 1000};
    const Aggregate block = test::make_block(3, 3, 3, 0.1, material);
    StageSpec stage;
    stage.sim.solver = Solver::explicit_steps;
    stage.machine.tool.resize(1);
    stage.machine.grip.resize(1);
    const std::vector<NamedMatter> one = {{"cube", &block}};
    const std::vector<NamedMatter> two = {{"cube", &block}, {"other", &block}};
    const auto says = [&](const std::vector<NamedMatter>& bodies, const char* words) {
        return stiffness_note(stage, bodies).find(words) != std::string::npos;
    };
    CHECK(stiffness_note(stage, two).empty());  // nothing was asked
    stage.sim.contact_stiffness = 0.2;
    CHECK(stiffness_note(stage, two).empty());  // and all is had
    stage.sim.contact_stiffness = 20;
    CHECK(says(one, "contact_stiffness = 20 acts as about "));
    CHECK(says(one, "under tools: "));
    CHECK(says(two, "between bodies"));
    CHECK_FALSE(says(two, "grip_stiffness"));
    stage.sim.grip_stiffness = 40;
    CHECK(says(one, "grip_stiffness = 40 acts as about "));
    const std::string told = stiffness_note(stage, two);
    const std::string word = "step_safety = ";
    stage.sim.step_safety = std::stod(told.substr(told.rfind(word) + word.size()));
    CHECK(stage.sim.step_safety < 0.8);
    CHECK(stiffness_note(stage, two).empty());
    CHECK(stiffness_share_at_tools(stage, two) > 0.9);
    stage.sim.step_safety = 0.8;
    stage.sim.solver = Solver::quasistatic;
    CHECK(stiffness_note(stage, two).empty());
}

TEST_CASE(
    "of several bodies the pair that steps leave least is told, in whatever order they stand") {
    const auto block = [](double modulus, double density) {
        return test::make_block(3, 3, 3, 0.1,
                                {.young_modulus = modulus, .poisson_ratio = 0, .density = density});
    };
    const Aggregate stiff = block(5e6, 1000), soft = block(5e4, 1000), heavy = block(4e6, 900);
    StageSpec stage;
    stage.sim.solver = Solver::explicit_steps;
    stage.sim.contact_stiffness = 20;
    const auto told = [&](const std::vector<const Aggregate*>& bodies) {
        std::vector<NamedMatter> named;
        for (const Aggregate* matter : bodies) named.push_back({"block", matter});
        return stiffness_note(stage, named);
    };
    const std::string note = told({&stiff, &heavy, &soft});
    CHECK(note.find("between bodies") != std::string::npos);
    CHECK(told({&stiff, &soft, &heavy}) == note);
    CHECK(told({&stiff, &soft, &heavy, &soft, &soft}) == note);
    // Two that are alike may meet too.
    CHECK_FALSE(told({&stiff, &soft, &stiff}).empty());
    CHECK(told({&stiff, &soft}).empty());
}
