// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/boundary_note.h"

#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

// Told of a box whose skin as it was made is so many times as large.
std::vector<std::string> told_of(double times, SkinKind kind) {
    InputMesh input;
    input.mesh = test::box_mesh({-0.2, -0.05, -0.05}, {0.2, 0.05, 0.05});
    BodySpec body;
    body.name = "box";
    body.mold.across = 3;
    std::vector<WorkPiece> bodies;
    bodies.push_back(make_work_piece(input, body, {kind}));
    for (Vec3& p : bodies[0].skin.position) p.x() *= times;
    return boundary_notes(bodies);
}

}  // namespace

TEST_CASE("a boundary that encloses a hundredth more or less than its matter is told of") {
    const std::vector<std::string> larger = told_of(1.03, SkinKind::boundary);
    REQUIRE(larger.size() == 1);
    CHECK(larger[0].find("the boundary of the work-piece encloses 3 % more than its matter") == 0);
    const std::vector<std::string> smaller = told_of(0.98, SkinKind::boundary);
    REQUIRE(smaller.size() == 1);
    CHECK(smaller[0].find("encloses 2 % less") != std::string::npos);
    CHECK(told_of(1, SkinKind::boundary).empty());
    CHECK(told_of(1.005, SkinKind::boundary).empty());
    CHECK(told_of(1.03, SkinKind::mount).empty());
}
