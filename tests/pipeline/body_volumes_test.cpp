// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/body_volumes.h"

#include <cmath>

#include "sim/cell_volume.h"
#include "skin/divided_mesh.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

// Round a quarter of a ring, and wider where it is pressed together.
Vec3 bend(const Vec3& p) {
    const double turn = p.x() / 0.2 * kPi / 2, radius = 0.2 / (kPi / 2) + p.y();
    return {radius * std::sin(turn), radius * std::cos(turn), (1 - 3 * p.y()) * p.z()};
}

WorkPiece bent_block(bool has_flowed, SkinKind kind = SkinKind::mount) {
    InputMesh input;
    input.mesh = divide_edges(test::box_mesh({-0.1, -0.05, -0.05}, {0.1, 0.05, 0.05}), 0.01);
    BodySpec body;
    body.name = "block";
    body.mold.across = 3;
    WorkPiece piece = make_work_piece(input, body, {kind});
    if (has_flowed) {
        piece.matter.cell_history.assign(piece.matter.cell_fill.size());
        for (float& one : piece.matter.cell_history.hardening()) one = 0.3f;
    }
    test::deform(piece.matter, bend);
    follow_matter(piece);
    return piece;
}

double share_of_matter(const WorkPiece& piece) {
    return present_volume(piece.matter) / piece.matter.volume();
}
double share_of_skin(const WorkPiece& piece) {
    return signed_volume(piece.deformed()) / signed_volume(piece.skin);
}

double largest_gap(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double gap = 0;
    for (std::size_t v = 0; v < a.size(); ++v) gap = std::max(gap, (a[v] - b[v]).norm());
    return gap;
}

}  // namespace

TEST_CASE("what matter takes up is what its strain says, and at rest what it was molded of") {
    WorkPiece piece = bent_block(false);
    test::deform(piece.matter, [](const Vec3& p) -> Vec3 {
        return {1.2 * p.x() + 0.3 * p.y(), 0.9 * p.y(), 1.1 * p.z()};
    });
    CHECK(present_volume(piece.matter) == Approx(0.002 * 1.2 * 0.9 * 1.1).epsilon(1e-6));
    test::sever_plane(piece.matter, {0.001, 0, 0}, Vec3::UnitX());  // cells without a size
    CHECK(present_volume(piece.matter) < 0.002 * 1.2 * 0.9 * 1.1);
    CHECK(present_volume(piece.matter) > 0.002);
}

TEST_CASE(
    "the skin of what has flowed takes up as much as its matter, of what has not it is left") {
    const WorkPiece flowed = bent_block(true), elastic = bent_block(false);
    CHECK(share_of_matter(flowed) == share_of_matter(elastic));
    CHECK(std::abs(share_of_skin(elastic) - share_of_matter(elastic)) > 1e-3);
    CHECK(share_of_skin(flowed) == Approx(share_of_matter(flowed)).epsilon(1e-6));
    CHECK(swollen_by(flowed).value() == Approx(0).margin(1e-6));
    CHECK_FALSE(swollen_by(elastic));
    std::vector<Vec3> mounted;
    skin_positions(elastic.mount, elastic.matter, mounted);
    CHECK(mounted == elastic.position);
}

TEST_CASE("the skin of what has flowed goes on from where it was as a blade or a load parts it") {
    WorkPiece piece = bent_block(true);
    const std::vector<Vec3> before = piece.position;
    const double a = piece.matter.lattice.spacing;
    SECTION("severed") {
        test::sever_plane(piece.matter, {0.001, 0, 0}, Vec3::UnitX());
        hold_skin(piece);
        CHECK(show_matter(piece, true) == 0);
        CHECK(largest_gap(piece.position, before) < 1e-9 * a);
    }
    SECTION("its skin cut first") {
        const Vec3 low(0.001, -1, -1), high(0.001, 1, -1), up(0, 0, 2);
        CHECK(cut_skins(piece, {{low, high, high + up}, {low, high + up, low + up}}).cuts == 1);
        follow_matter(piece);
        for (const Vec3& p : before) {  // its vertices stay, and others lie between them
            double least = 1;
            for (const Vec3& q : piece.position) least = std::min(least, (q - p).norm());
            REQUIRE(least < 1e-9 * a);
        }
    }
    CHECK(piece.is_parted);
    CHECK_FALSE(swollen_by(piece));
}

TEST_CASE("volumes are told by body, of a skin only where it is closed") {
    std::vector<WorkPiece> bodies;
    bodies.push_back(bent_block(true));
    const std::vector<BodyVolume> start = body_volumes(bodies);
    test::deform(bodies[0].matter, [](const Vec3& p) -> Vec3 { return 1.1 * p; });
    follow_matter(bodies[0]);
    const Json told = volumes_json(bodies, start)["block"];
    CHECK(told["matter_at_start"] == start[0].matter);
    CHECK(told["skin_at_start"] == *start[0].skin);
    CHECK(told["matter"].get<double>() == Approx(0.002 * 1.331).epsilon(1e-6));
    CHECK(told["skin"].get<double>() == Approx(0.002 * 1.331).epsilon(1e-6));
    bodies[0].skin.triangle.pop_back();
    const Json open = volumes_json(bodies, body_volumes(bodies))["block"];
    CHECK(open.contains("matter"));
    CHECK_FALSE(open.contains("skin"));
    CHECK_FALSE(open.contains("skin_at_start"));
}
