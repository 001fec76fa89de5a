// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of several materials that blades cut: what their cut faces show.
#include <map>

#include "pipeline/body_look.h"
#include "pipeline/work_piece.h"
#include "skin/new_look.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"

using namespace swage;
using test::box_mesh;

namespace {

const Vec3 kSize(0.4, 0.1, 0.1);
constexpr double kSection = 0.1 * 0.1;

InputMesh bar() {
    InputMesh input;
    input.mesh = box_mesh(-0.5 * kSize, 0.5 * kSize);
    return input;
}

InsetSpec box_inset(const Vec3& from, const Vec3& to, const std::string& name = "core") {
    InsetSpec inset;
    inset.from = from, inset.to = to;
    inset.material.name = name;
    inset.material.density = 3000;
    return inset;
}
// Along all of it, and of no whole cells.
InsetSpec core() { return box_inset({0, 0.27, 0.31}, {1, 0.71, 0.64}); }
InsetSpec layer() { return box_inset({0, 0.43, 0}, {1, 1, 1}, "layer"); }
double section_of(const InsetSpec& inset) {
    return (inset.to - inset.from).tail<2>().prod() * kSection;
}

BodySpec body_of(std::vector<InsetSpec> insets, int across = 6) {
    BodySpec body;
    body.material.density = 1000;
    body.inset = std::move(insets);
    body.mold.across = across;
    return body;
}

WorkPiece make(const BodySpec& body, SkinKind kind = SkinKind::mount) {
    return make_work_piece(bar(), body, {kind}, true);
}

void cut(WorkPiece& piece, const Vec3& point, const Vec3& normal) {
    const Vec3 across = normal.unitOrthogonal(), up = normal.cross(across);
    const auto corner = [&](double u, double v) -> Vec3 { return point + u * across + v * up; };
    CHECK(cut_skins(piece, {{corner(-1, -1), corner(1, -1), corner(1, 1)},
                            {corner(-1, -1), corner(1, 1), corner(-1, 1)}})
              .open_parts == 0);
    follow_matter(piece);
}

// The same, what lies on its positive side moved by that much.
void part(WorkPiece& piece, const Vec3& point, const Vec3& normal, const Vec3& apart) {
    cut(piece, point, normal);
    test::sever_plane(piece.matter, point, normal);
    for (std::size_t p = 0; p < piece.matter.particle_count(); ++p) {
        if (normal.dot(piece.matter.particle_reference.at(p) - point) > 0) {
            piece.matter.particle_position.add(p, apart);
        }
    }
    show_matter(piece, true);
}

// By look; of faces that look along the normal or against it.
std::map<std::string, std::array<double, 2>> cut_areas(const WorkPiece& piece, const Vec3& normal) {
    std::map<std::string, std::array<double, 2>> area;
    for (std::size_t t = 0; t < piece.skin.triangle.size(); ++t) {
        const SurfaceMaterial& look = piece.skin.material[piece.skin.triangle_material[t]];
        const Vec3 own = 0.5 * area_vector(piece.position, piece.skin.triangle[t]);
        const double along = own.dot(normal);
        if (!is_cut_look(look) || std::abs(along) < 0.9 * own.norm()) continue;
        area[look.name][along > 0 ? 0 : 1] += std::abs(along);
    }
    return area;
}

void check_both(const std::array<double, 2>& area, double should, double within = 1e-3) {
    CHECK(area[0] == Approx(should).epsilon(within));
    CHECK(area[1] == Approx(should).epsilon(within));
}

}  // namespace

TEST_CASE("a cut face shows the insets of its body, however its skin is made") {
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::boundary);
    for (const Vec3& normal : {Vec3::UnitX().eval(), Vec3(Vec3(2, 1, 0.4).normalized())}) {
        WorkPiece piece = make(body_of({core()}), kind);
        part(piece, {0.011, 0.003, 0}, normal, 0.13 * normal);
        CHECK(test::is_closed(piece.skin));
        const auto area = cut_areas(piece, normal);
        check_both(area.at("cut_core"), section_of(core()) / normal.x());
        check_both(area.at("cut"), (kSection - section_of(core())) / normal.x(),
                   kind == SkinKind::mount ? 1e-3 : 0.02);
    }
}

TEST_CASE("a layer shows up to the surface of its body") {
    WorkPiece piece = make(body_of({layer(), box_inset({0, 0, 0}, {1, 0.2, 1}, "foot")}));
    part(piece, {0.011, 0.003, 0}, Vec3::UnitX(), {0.1, 0, 0});
    const auto area = cut_areas(piece, Vec3::UnitX());
    check_both(area.at("cut_layer"), section_of(layer()), 1e-6);
    check_both(area.at("cut_foot"), 0.2 * kSection, 1e-6);
    check_both(area.at("cut"), 0.23 * kSection, 1e-6);
}

TEST_CASE("a body that was bent shows its insets where they have come to be") {
    WorkPiece piece = make(body_of({core(), layer()}));
    const double radius = kSize.x() / (kPi / 2);
    test::deform(piece.matter, [&](const Vec3& x) {
        const double turn = x.x() / radius, r = radius + x.y();
        return Vec3(r * std::sin(turn), r * std::cos(turn), x.z());
    });
    follow_matter(piece);
    const double turn = 0.05 / radius;
    const Vec3 normal(std::cos(turn), -std::sin(turn), 0);
    cut(piece, Vec3::Zero(), normal);  // through the axis of the bend
    const auto area = cut_areas(piece, normal);
    const double above = 0.57 * kSection, below = (0.43 - 0.27) * (0.64 - 0.31) * kSection;
    check_both(area.at("cut_layer"), above, 5e-3);
    check_both(area.at("cut_core"), below, 5e-3);
    // A layer that goes to the surface is not left out along it.
    check_both(area.at("cut"), kSection - above - below, 1e-2);
}

TEST_CASE("pieces that are cut again show their insets again, molded anew or not") {
    const bool remolds = GENERATE(false, true);
    const BodySpec body = body_of({core()});
    WorkPiece piece = make(body);
    part(piece, {0.011, 0, 0}, Vec3::UnitX(), {0.1, 0, 0});
    if (remolds) {
        piece = mold_anew(piece, body, {}, true);
        CHECK(piece.finding.empty());
    }
    // Along both of them.
    cut(piece, {0, 0.003, 0}, Vec3::UnitY());
    CHECK(test::is_closed(piece.skin));
    check_both(cut_areas(piece, Vec3::UnitX()).at("cut_core"), section_of(core()), 5e-3);
    const double width = (0.64 - 0.31) * kSize.z();
    check_both(cut_areas(piece, Vec3::UnitY()).at("cut_core"), width * kSize.x(), 5e-3);
    check_both(cut_areas(piece, Vec3::UnitY()).at("cut"), (kSize.z() - width) * kSize.x(), 5e-3);
}

TEST_CASE("what a cut face shows looks as its material or as it is asked, and unlike the rest") {
    SurfaceMaterial tin;
    tin.color = {0.8, 0.78, 0.7}, tin.metallic = 1, tin.roughness = 0.2;
    BodySpec body = body_of({core(), core(), core(), layer(), layer()});
    body.inset[0].look = tin;
    body.inset[1].color = Vec3(0.1, 0.7, 0.2);
    body.inset[3].material.name = body.inset[4].material.name = Material().name;
    const std::vector<SurfaceMaterial> looks = inset_looks(body, bar().mesh);
    const SurfaceMaterial cut = cut_look(bar().mesh);
    REQUIRE(looks.size() == 5);
    CHECK(looks[0].name == "cut_core");
    CHECK(looks[0].color == tin.color);
    CHECK(looks[0].metallic == 1);
    CHECK(looks[0].roughness >= cut.roughness);
    CHECK(looks[1].name == "cut_core_2");
    CHECK(looks[1].color == Vec3(0.1, 0.7, 0.2));
    CHECK(looks[1].metallic == 0);
    CHECK(looks[3].name == "cut_4");
    CHECK(looks[4].name == "cut_5");
    for (std::size_t n : {2, 3, 4}) {
        CHECK((looks[n].color - cut.color).cwiseAbs().maxCoeff() > 0.05);
        CHECK((looks[n].color - looks[n - 1].color).cwiseAbs().maxCoeff() > 0.05);
    }
    for (const SurfaceMaterial& look : looks) CHECK(is_cut_look(look));

    // Of the same metal as the body.
    body.look = tin;
    TriMesh dressed = bar().mesh;
    dressed.material = {tin};
    const SurfaceMaterial same = inset_looks(body, dressed)[0];
    CHECK((same.color - tin.color).cwiseAbs().maxCoeff() > 0.05);
    CHECK(same.metallic == 1);
}

TEST_CASE("the surfaces of insets are carried as long as a stage cuts or remolds") {
    SceneSpec scene;
    scene.body.push_back(body_of({core()}));
    scene.stage.resize(3);
    CHECK_FALSE(carries_insets(scene, 0));
    scene.stage[1].machine.blade.emplace_back();
    CHECK(carries_insets(scene, 0));
    CHECK(carries_insets(scene, 1));
    CHECK_FALSE(carries_insets(scene, 2));
    scene.stage[1].remold = true;
    CHECK(carries_insets(scene, 1, true));
    scene.stage[1].machine.blade.clear();
    CHECK(carries_insets(scene, 1));
    CHECK_FALSE(carries_insets(scene, 1, true));
    scene.body[0].inset.clear();
    CHECK_FALSE(carries_insets(scene, 0));
}

TEST_CASE("an inset's surface that was left open is told where the body is molded anew") {
    const BodySpec body = body_of({layer(), core()}, 4);
    WorkPiece piece = make(body);
    CHECK(mold_anew(piece, body, {}).finding.empty());
    piece.inset[1].mesh.triangle.pop_back();
    CHECK(mold_anew(piece, body, {}).finding ==
          std::vector<std::string>{"the surface of inset 2 was left open in 1 place where it was "
                                   "cut or broke, and is closed by cones"});
}
