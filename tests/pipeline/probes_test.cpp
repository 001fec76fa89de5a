// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/probes.h"

#include "pipeline/curves.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"

using namespace swage;
using test::box_mesh;

namespace {

const Vec3 kEnd(1, 0.5, 0.25), kInside(0.3, 0.6, 0.7);  // shares of the box

BodySpec probed_bar() {
    BodySpec body;
    body.mold.across = 3;
    body.probe = {{"end", kEnd, {}}, {"inside", kInside, {}}};
    return body;
}

WorkPiece bar(const BodySpec& body, SkinKind kind) {
    InputMesh input;
    input.mesh = box_mesh({-0.2, -0.05, -0.1}, {0.2, 0.05, 0.1});
    return make_work_piece(input, body, {kind});
}

Vec3 in_bar(const Vec3& share) {
    return Vec3(-0.2, -0.05, -0.1) + share.cwiseProduct(Vec3(0.4, 0.1, 0.2));
}

// What lies beyond that place along x is parted and goes by what is returned.
Vec3 draw_apart(Aggregate& matter, double cut) {
    test::sever_plane(matter, {cut, 0, 0}, Vec3::UnitX());
    const Vec3 apart(0.3, 0, 0);
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        if (matter.particle_reference.at(p).x() > cut) matter.particle_position.add(p, apart);
    }
    return apart;
}

}  // namespace

TEST_CASE("a probe follows the matter exactly where that turns, moves and is drawn evenly") {
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::frame4, SkinKind::boundary);
    BodySpec body = probed_bar();
    body.start.at = Vec3(1, 2, 3);
    body.start.turn = Vec3(0.3, -0.4, 0.5);
    WorkPiece piece = bar(body, kind);
    const auto placed = [&](const Vec3& x) {
        return Vec3(turn_by(body.start.turn).toRotationMatrix() * x + *body.start.at);
    };
    std::vector<ProbePlace> found = probe_places({body}, {piece});
    REQUIRE(found.size() == 2);
    CHECK(found[0].name == "end");
    CHECK((found[0].place - placed(in_bar(kEnd))).norm() < 1e-12);
    CHECK((found[1].place - placed(in_bar(kInside))).norm() < 1e-12);

    const Vec3 drawn(1.5, 0.8, 1.1);
    Vec3Array& x = piece.matter.particle_position;
    for (std::size_t p = 0; p < x.size(); ++p) x.set(p, x.at(p).cwiseProduct(drawn));
    found = probe_places({body}, {piece});
    CHECK((found[0].place - placed(in_bar(kEnd)).cwiseProduct(drawn)).norm() < 1e-12);
}

TEST_CASE("a probe goes on from where it was once the matter is molded anew") {
    const BodySpec body = probed_bar();
    WorkPiece piece = bar(body, SkinKind::mount);
    Vec3Array& x = piece.matter.particle_position;
    for (std::size_t p = 0; p < x.size(); ++p) {
        x.set(p, x.at(p).cwiseProduct(Vec3(0.8, 1.2, 1.1)) + Vec3(3, 0, 0));
    }
    follow_matter(piece);
    const std::vector<ProbePlace> before = probe_places({body}, {piece});
    WorkPiece anew = mold_anew(piece, body, {SkinKind::mount});
    std::vector<ProbePlace> after = probe_places({body}, {anew});
    REQUIRE(after.size() == 2);
    for (int n : {0, 1}) CHECK((after[n].place - before[n].place).norm() < 1e-12);
    anew.matter.particle_position.add(0, Vec3::Zero());
    for (std::size_t p = 0; p < anew.matter.particle_count(); ++p) {
        anew.matter.particle_position.add(p, {0, 0.1, 0});
    }
    after = probe_places({body}, {anew});
    for (int n : {0, 1}) CHECK((after[n].place - before[n].place - Vec3(0, 0.1, 0)).norm() < 1e-12);
}

TEST_CASE("a probe in a cell that is parted goes with its own side") {
    BodySpec body = probed_bar();
    body.probe = {{"left", Vec3(0.49, 0.5, 0.5), {}}, {"right", Vec3(0.51, 0.5, 0.5), {}}};
    body.mold.across = 4;
    WorkPiece piece = bar(body, SkinKind::mount);
    const double cut = 0.5 * piece.matter.lattice.spacing;  // in the middle of a cell
    for (int n : {0, 1}) body.probe[n].at.x() += cut / 0.4;
    piece = bar(body, SkinKind::mount);
    const std::vector<ProbePlace> before = probe_places({body}, {piece});
    const Vec3 apart = draw_apart(piece.matter, cut);
    const std::vector<ProbePlace> after = probe_places({body}, {piece});
    CHECK((after[0].place - before[0].place).norm() < 1e-12);
    CHECK((after[1].place - before[1].place - apart).norm() < 1e-12);
}

TEST_CASE(
    "a probe goes with the side of the blade's path that it lies on, not of the next corner") {
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::boundary);
    BodySpec body = probed_bar();
    body.mold.across = 4;
    const double a = bar(body, kind).matter.lattice.spacing;
    const double share = GENERATE(0.1, 0.3, 0.7, 0.95);  // of the cell that the blade goes through
    const double cut = share * a;
    for (int n : {0, 1}) {
        const double x = cut + (n == 0 ? -0.02 : 0.02) * a;
        body.probe[n].at = Vec3(0.5 + x / 0.4, 0.4, 0.6);
    }
    WorkPiece piece = bar(body, kind);
    const std::vector<ProbePlace> before = probe_places({body}, {piece});
    cut_skins(piece, {{Vec3(cut, -1, -1), Vec3(cut, 1, -1), Vec3(cut, 1, 1)},
                      {Vec3(cut, -1, -1), Vec3(cut, 1, 1), Vec3(cut, -1, 1)}});
    const Vec3 apart = draw_apart(piece.matter, cut);
    const std::vector<ProbePlace> after = probe_places({body}, {piece});
    CHECK((after[0].place - before[0].place).norm() < 1e-12);
    CHECK((after[1].place - before[1].place - apart).norm() < 1e-12);
}

TEST_CASE("a probe beside the matter is refused where the scene asks for it") {
    InputMesh input;
    input.mesh = test::together(box_mesh({-0.2, -0.05, -0.1}, {0, 0.05, 0.1}),
                                box_mesh({0, 0.05, -0.1}, {0.2, 0.1, 0.1}));
    BodySpec body = probed_bar();
    body.mold.across = 8;
    body.probe = {
        {"corner", Vec3(1, 0, 0.5), {std::make_shared<const Source>(Source{"s.toml", ""}), 7, 6}}};
    CHECK_THROWS_WITH(make_work_piece(input, body, {SkinKind::mount}),
                      Catch::StartsWith("s.toml:7:6: probe \"corner\" is ") &&
                          Catch::EndsWith(" outside the matter"));
}

TEST_CASE("probes stand in the table, a place a row, the start's first") {
    StageCurves curves("1-rest", 1, {}, {}, 0, {}, {{"tip", Vec3(1, 2, 3)}});
    curves.add(2, FrameReport{}, {{"tip", Vec3(1, 2, 2.5)}});
    const std::string text = csv_text(curves);
    CHECK(text.find("frame,time [s],tip x [m],tip y [m],tip z [m],kinetic energy [J]") == 0);
    CHECK(text.find("\n1,0,1,2,3,") != std::string::npos);
    CHECK(text.find("\n2,0,1,2,2.5,") != std::string::npos);
}

TEST_CASE("fields at a probe are those of the matter there, whatever others ask of it") {
    BodySpec body = probed_bar();
    body.material.young_modulus = 200e9;
    body.material.poisson_ratio = 0.3;
    body.probe[0].fields = {SkinField::stress, SkinField::pressure};
    body.probe[1].fields = {SkinField::principal_stress, SkinField::stress};
    WorkPiece piece = bar(body, SkinKind::mount);
    // Bent by a curvature about z, fibres of each height as if drawn alone: E y kappa.
    constexpr double kKappa = 1e-3;
    Vec3Array& x = piece.matter.particle_position;
    for (std::size_t p = 0; p < x.size(); ++p) {
        const Vec3 at = x.at(p);
        const double across = 0.5 * kKappa * 0.3;
        x.add(p, {kKappa * at.x() * at.y(),
                  -0.5 * kKappa * at.x() * at.x() + across * (at.z() * at.z() - at.y() * at.y()),
                  -2 * across * at.y() * at.z()});
    }
    const std::vector<ProbePlace> found = probe_places({body}, {piece});
    REQUIRE(found[0].field == std::vector{SkinField::stress, SkinField::pressure});
    REQUIRE(found[1].field == std::vector{SkinField::principal_stress, SkinField::stress});
    // Three cells across: what is within a cell is as good as its middle.
    const double inside = 200e9 * kKappa * in_bar(kInside).y();
    CHECK(found[0].value[0] == Approx(0).margin(0.02 * inside));
    CHECK(found[0].value[1] == Approx(0).margin(0.02 * inside));
    CHECK(found[1].value[0] == Approx(inside).epsilon(0.02));
    CHECK(found[1].value[1] == Approx(inside).epsilon(0.02));

    const StageCurves curves("1-bend", 0, {}, FrameReport(), 0, {}, found);
    const std::string table = csv_text(curves);
    CHECK(table.find("end z [m],end stress [Pa],end pressure [Pa],inside x [m]") !=
          std::string::npos);
    CHECK(table.find("inside principal_stress [Pa],inside stress [Pa],kinetic") !=
          std::string::npos);
}
