// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work_piece.h"

#include <Eigen/Geometry>

#include "geometry/make_shape.h"
#include "geometry/mesh_write.h"
#include "geometry/triangle_tree.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"
#include "tests/shared/scratch.h"

using namespace swage;
using test::box_mesh;
using test::together;
using test::turned_inside_out;

namespace {

WorkPiece block(const StartSpec& start, SkinKind skin) {
    InputMesh input;
    input.mesh = make_shape("bar", {{"length", 0.4}, {"height", 0.1}, {"width", 0.2}}).mesh;
    BodySpec body;
    body.start = start;
    body.mold.across = 3;
    body.color = Vec3(0.5, 0, 0);
    return make_work_piece(input, body, {skin});
}

// Cut across its length, what lies on the right moved by that much.
WorkPiece parted_block(SkinKind kind, const Vec3& apart) {
    WorkPiece piece = block({}, kind);
    const double x = 0.01;
    const Vec3 a(x, -1, -1), b(x, 1, -1), up(0, 0, 2);
    cut_skins(piece, {{a, b, b + up}, {a, b + up, a + up}});
    test::sever_plane(piece.matter, {x, 0, 0}, Vec3::UnitX());
    for (std::size_t p = 0; p < piece.matter.particle_count(); ++p) {
        if (piece.matter.particle_reference.at(p).x() > x) {
            piece.matter.particle_position.add(p, apart);
        }
    }
    show_matter(piece, true);
    return piece;
}

// What a run makes of a file that holds this mesh.
InputMesh read_from_file(const TriMesh& mesh) {
    const Scratch scratch;
    const std::filesystem::path file = scratch.path() / "mesh.obj";
    write_obj(file, mesh);
    MeshSpec spec;
    spec.file = file;
    return read_input_mesh(spec, MoldKind::shape);
}

// Round a quarter of a ring: the box is as high as it is long then.
void bend_round(Aggregate& m) {
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        const double turn = x.x() / 0.4 * kPi / 2, radius = 0.4 / (kPi / 2) + x.y();
        m.particle_position.set(p, {radius * std::sin(turn), radius * std::cos(turn), x.z()});
    }
}

// By load, all across.
void break_at(Aggregate& m, double x) {
    for (ConnectionArrays& all : m.connection) all.damage.resize(m.particle_count());
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n, upper = span.upper + n;
            if ((m.particle_reference.at(lower).x() < x) ==
                (m.particle_reference.at(upper).x() < x))
                continue;
            m.connection[span.direction].weight.set(lower, 0);
            m.connection[span.direction].damage[lower] = 1;
        }
    }
}

// Triangles with an edge longer than this.
int longer_than(double length, const TriMesh& mesh, const std::vector<Vec3>& position) {
    int count = 0;
    for (const Corners& t : mesh.triangle) {
        double longest = 0;
        for (int k = 0; k < 3; ++k) {
            longest = std::max(longest, (position[t[k]] - position[t[(k + 1) % 3]]).norm());
        }
        count += longest > length;
    }
    return count;
}

struct Sums {
    double mass = 0;
    Vec3 centre = Vec3::Zero(), momentum = Vec3::Zero(), turning = Vec3::Zero();
};
Sums sums_of(const Aggregate& m) {
    Sums s;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        s.mass += m.particle_mass[p];
        s.centre += m.particle_mass[p] * m.particle_position.at(p);
        s.momentum += m.particle_mass[p] * m.particle_velocity.at(p);
    }
    s.centre /= s.mass;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        s.turning += m.particle_mass[p] *
                     (m.particle_position.at(p) - s.centre).cross(m.particle_velocity.at(p));
    }
    return s;
}

}  // namespace

TEST_CASE("a look without a name is called after the body, or the file of one without") {
    for (SkinKind kind : {SkinKind::mount, SkinKind::boundary}) {
        for (bool is_painted : {false, true}) {
            InputMesh input;
            input.mesh = box_mesh({0, 0, 0}, {0.3, 0.1, 0.1});
            BodySpec body;
            body.mesh.file = "/meshes/beam.stl";
            body.mold.across = 2;
            if (is_painted) body.color = Vec3(0.5, 0, 0);
            const auto looks = [&] {
                const WorkPiece piece = make_work_piece(input, body, {kind});
                std::vector<std::string> names;
                for (const SurfaceMaterial& look : piece.skin.material) names.push_back(look.name);
                CHECK(piece.skin.triangle_material.size() == piece.skin.triangle.size());
                return names;
            };
            CHECK(looks() == std::vector<std::string>{"beam"});
            body.name = "left";
            CHECK(looks() == std::vector<std::string>{"left"});
            input.mesh.material.resize(1);
            input.mesh.material[0].name = "oak";
            CHECK(looks() == std::vector<std::string>{is_painted ? "left" : "oak"});
        }
    }
}

TEST_CASE("a body starts where it is told to, turned about its middle, with its skin") {
    StartSpec start;
    start.at = Vec3(1, 2, 3);
    start.turn = {0, 0, kPi / 2};
    for (SkinKind skin : {SkinKind::mount, SkinKind::frame4, SkinKind::boundary}) {
        const WorkPiece piece = block(start, skin);
        const Box box = box_of(piece.position);
        const double slack = skin == SkinKind::boundary ? 0.05 : 1e-9;
        CHECK((box.center() - *start.at).norm() < slack);
        CHECK((box.size() - Vec3(0.1, 0.4, 0.2)).norm() < 2 * slack);
        REQUIRE(piece.skin.material.size() == 1);
        CHECK(piece.skin.material[0].color == Vec3(0.5, 0, 0));
        // Turned as a whole, so that nothing is strained: every edge of the lattice has its length.
        const Aggregate& m = piece.matter;
        double worst = 0;
        for (const Span& span : m.lattice.span) {
            for (int n = 0; n < span.count; ++n) {
                const double length = (m.particle_position.at(span.upper + n) -
                                       m.particle_position.at(span.lower + n))
                                          .norm();
                worst =
                    std::max(worst, std::abs(length - reference_length(m.lattice, span.direction)));
            }
        }
        CHECK(worst < 1e-12);
    }
}

TEST_CASE("a round body stands where it is told to, however coarse its matter is") {
    InputMesh input;
    input.mesh = make_shape("sphere", {}).mesh;
    BodySpec body;
    body.start.at = Vec3(1, 2, 3);
    for (int across : {1, 2, 5}) {
        body.mold.across = across;
        for (Vec3& p : input.mesh.position)
            p.y() *= p.y() > 0 ? 1.1 : 1;  // no twin of its other half
        const WorkPiece piece = make_work_piece(input, body, {SkinKind::mount});
        INFO(across);
        CHECK((box_of(piece.position).center() - *body.start.at).norm() < 1e-9);
    }
}

TEST_CASE("a body that is told no start is left as it was molded") {
    const WorkPiece piece = block({}, SkinKind::mount);
    CHECK(piece.matter.particle_position.x == piece.matter.particle_reference.all().x);
    CHECK(piece.matter.particle_velocity.x ==
          std::vector<double>(piece.matter.particle_count(), 0.0));
}

TEST_CASE(
    "matter molded anew keeps the size of its cells, but for what makes whole layers of them") {
    WorkPiece piece = block({}, SkinKind::mount);
    bend_round(piece.matter);
    follow_matter(piece);
    BodySpec body;
    body.mold.across = 3;
    const WorkPiece anew = mold_anew(piece, body, {});
    const double spacing = anew.matter.lattice.spacing;
    CHECK(spacing == Approx(piece.matter.lattice.spacing).epsilon(1.0 / 6));
    const double layers = box_of(piece.position).size().minCoeff() / spacing;
    CHECK(layers == Approx(std::round(layers)).epsilon(1e-9));
    CHECK(anew.matter.volume() == Approx(0.008).epsilon(0.05));
}

TEST_CASE("matter molded anew is as heavy as it was, pressed together or drawn") {
    WorkPiece piece = block({}, SkinKind::mount);
    const double mass = piece.matter.mass();
    BodySpec body;
    body.mold.across = 3;
    for (const double high : {0.7, 1.5}) {
        Vec3Array& x = piece.matter.particle_position;
        for (std::size_t p = 0; p < x.size(); ++p) {
            x.set(p, x.at(p).cwiseProduct(Vec3(1, high, 1)));
        }
        follow_matter(piece);
        piece = mold_anew(piece, body, {});
        CHECK(piece.matter.mass() == Approx(mass).epsilon(1e-6));
    }
}

TEST_CASE("matter molded anew is as heavy as it was where its pieces lie in each other") {
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::boundary);
    const WorkPiece piece = parted_block(kind, {-0.08, 0.01, 0});
    const double mass = piece.matter.mass();
    BodySpec body;
    body.mold.across = 3;
    const WorkPiece anew = mold_anew(piece, body, {kind});
    CHECK(anew.matter.volume() < 0.9 * piece.matter.volume());
    CHECK(anew.matter.mass() == Approx(mass).epsilon(1e-9));
}

TEST_CASE("a mesh of twelve triangles bends with its matter, and so does what is molded of it") {
    InputMesh input;
    input.mesh = box_mesh({-0.2, -0.05, -0.1}, {0.2, 0.05, 0.1});
    BodySpec body;
    body.mold.across = 3;
    for (SkinKind kind : {SkinKind::mount, SkinKind::frame4}) {
        WorkPiece piece = make_work_piece(input, body, {kind});
        CHECK(signed_volume(piece.deformed()) == Approx(0.008));
        bend_round(piece.matter);
        follow_matter(piece);
        CHECK(signed_volume(piece.deformed()) == Approx(0.008).epsilon(0.02));
        CHECK(mold_anew(piece, body, {kind}).matter.volume() == Approx(0.008).epsilon(0.02));
    }
    // Its own triangles and no others, where that is asked for.
    const WorkPiece own = make_work_piece(input, body, {SkinKind::mount, std::nullopt});
    CHECK(own.skin.triangle == input.mesh.triangle);
}

TEST_CASE("velocity and spin at the start are those of the body's centre of mass") {
    StartSpec start;
    start.velocity = {1, -2, 0.5};
    start.spin = {0, 0, 7};
    const WorkPiece piece = block(start, SkinKind::mount);
    const Sums s = sums_of(piece.matter);
    CHECK((s.momentum - s.mass * start.velocity).norm() < 1e-12 * s.mass);
    // Of a block of 0.4 x 0.1 about its third axis, as far as its corners are not round.
    const double inertia = s.mass * (0.4 * 0.4 + 0.1 * 0.1) / 12;
    CHECK(std::abs(s.turning.z() / (7 * inertia) - 1) < 0.1);
}

TEST_CASE("a mesh with one body inside out is molded whole") {
    const TriMesh large = box_mesh({0, 0, 0}, {2, 1, 1}), small = box_mesh({3, 0, 0}, {4, 1, 1});
    const InputMesh input = read_from_file(together(large, turned_inside_out(small)));
    REQUIRE(input.repair.size() == 1);
    CHECK(input.repair[0] == "turned 1 of 2 bodies: inside out");
    BodySpec body;
    body.mold.across = 3;
    CHECK(make_work_piece(input, body, {}).matter.volume() == Approx(3));
}

TEST_CASE("what two bodies of a mesh share is molded once") {
    const TriMesh ball = test::sphere_mesh(1, 3);
    const TriMesh other = test::moved(ball, {Quat::Identity(), {0.9, 0.1, 0.2}});
    const InputMesh crossing = read_from_file(together(ball, other));
    REQUIRE(crossing.repair.size() == 1);
    CHECK(crossing.repair[0].find("united 2 crossing bodies") == 0);
    // Two caps of the height by which each passes the plane between the two.
    const double cap = 1 - 0.5 * Vec3(0.9, 0.1, 0.2).norm();
    const double common = 2 * kPi * cap * cap * (3 - cap) / 3;
    BodySpec body;
    body.mold.across = 12;
    const double volume = make_work_piece(crossing, body, {}).matter.volume();
    CHECK(volume == Approx(2 * 4 * kPi / 3 - common).epsilon(0.01));

    const InputMesh inside =
        read_from_file(together(ball, box_mesh({-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3})));
    CHECK(inside.repair.size() == 1);
    CHECK(signed_volume(inside.to_mold()) == Approx(signed_volume(ball)));
}

TEST_CASE("a mesh whose bodies are sound is taken as it is") {
    TriMesh mesh = box_mesh({0, 0, 0}, {3, 3, 3});
    mesh = together(mesh, turned_inside_out(box_mesh({1, 1, 1}, {2, 2, 2})));  // a cavity
    mesh = together(mesh, box_mesh({3, 1, 1}, {4, 2, 2}));                     // touches
    const InputMesh input = read_from_file(mesh);
    CHECK(input.repair.empty());
    CHECK(input.mesh.position == mesh.position);
    CHECK(input.mesh.triangle == mesh.triangle);
}

TEST_CASE("a file's own look that is called as a cut's is another") {
    TriMesh mesh = together(box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({2, 0, 0}, {3, 1, 1}));
    const std::string name = GENERATE("cut", "cut_lead", "cut_");
    mesh.material = {{.name = "painted"}, {.name = name, .color = {0.1, 0.2, 0.3}}};
    // Colours of one alone, which has the other take none.
    for (const Vec3& p : mesh.position) {
        mesh.position_color.push_back(Eigen::Vector3f(1, p.x() < 1.5 ? 0.5f : 1, 1));
    }
    for (const Corners& t : mesh.triangle) {
        mesh.triangle_material.push_back(mesh.position[t[0]].x() > 1.5);
    }
    TriMesh read = read_from_file(mesh).mesh;
    const auto own = std::ranges::find(read.material, false, &SurfaceMaterial::takes_colors);
    REQUIRE(own != read.material.end());
    CHECK_FALSE(is_cut_look(*own));
    CHECK(inside_material(read, {.name = name, .takes_colors = false}) == 2);
    CHECK(is_cut_look(read.material[2]));
}

TEST_CASE("an inset that a body cannot have is told where the scene names it") {
    const Scratch scratch;
    InputMesh input;
    input.mesh = make_shape("bar", {{"length", 0.4}, {"height", 0.1}, {"width", 0.2}}).mesh;
    BodySpec body;
    body.mold.across = 2;
    const auto source = std::make_shared<const Source>(Source{"s.toml", ""});
    for (const char* name : {"in.obj", "out.obj"}) {
        InsetSpec& inset = body.inset.emplace_back();
        inset.file = scratch.path() / name;
        inset.place = {source, static_cast<int>(3 * body.inset.size()), 8};
        const Vec3 at(name[0] == 'i' ? 0 : 7, 0, 0);
        write_obj(inset.file, box_mesh(at - Vec3(0.1, 0.02, 0.05), at + Vec3(0.1, 0.02, 0.05)));
    }
    std::vector<std::string> findings;
    try {
        mold_body(input, body, findings);
        FAIL("it lies outside");
    } catch (const SceneError& error) {
        CHECK(error.code() == ExitCode::mesh);
        CHECK(error.what() ==
              std::string("s.toml:6:8: cannot mold: inset 2 lies outside the work-piece"));
    }
    std::filesystem::remove(body.inset[0].file);
    CHECK_THROWS_WITH(mold_body(input, body, findings), Catch::StartsWith("s.toml:3:8: "));
}

TEST_CASE("a body in motion is molded anew in motion") {
    StartSpec start;
    start.velocity = Vec3(3, -1, 2);
    start.spin = Vec3(1, 4, -2);
    const WorkPiece piece = block(start, SkinKind::mount);
    BodySpec body;
    body.mold.across = 3;
    const Sums before = sums_of(piece.matter), after = sums_of(mold_anew(piece, body, {}).matter);
    CHECK((after.momentum - before.momentum).norm() < 1e-9 * before.momentum.norm());
    CHECK((after.turning - before.turning).norm() < 1e-9 * before.turning.norm());
}

TEST_CASE("a painted body that is molded anew keeps its colour, and cut faces keep theirs") {
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::boundary);
    const WorkPiece piece = parted_block(kind, {0.3, 0, 0});
    REQUIRE(piece.skin.material.size() == 2);
    BodySpec body;
    body.mold.across = 3;
    const bool wears_material = GENERATE(false, true);
    if (wears_material) {
        body.look = SurfaceMaterial{.color = Vec3(0, 0.5, 0)};
        body.wears_material = true;
    } else {
        body.color = Vec3(0.5, 0, 0);
    }
    const TriMesh skin = mold_anew(piece, body, {kind}).skin;
    REQUIRE(skin.material.size() >= 2);
    CHECK(skin.material[0].color == Vec3(0.5, 0, 0));
    CHECK(skin.material[1].color == piece.skin.material[1].color);
    CHECK(skin.material[1].color != Vec3(0.5, 0, 0));
    for (int material : {0, 1}) {
        const auto& of = skin.triangle_material;
        CHECK(std::find(of.begin(), of.end(), material) != of.end());
    }
}

TEST_CASE("a painted block that is molded anew keeps its colour") {
    InputMesh input;
    input.mesh = box_mesh({-0.2, -0.05, -0.1}, {0.2, 0.05, 0.1});
    BodySpec body;
    body.mold.across = 3;
    body.mold.kind = MoldKind::block;
    body.color = Vec3(0.5, 0, 0);
    for (SkinKind kind : {SkinKind::mount, SkinKind::boundary}) {
        const WorkPiece piece = make_work_piece(input, body, {kind});
        const TriMesh skin = mold_anew(piece, body, {kind}).skin;
        REQUIRE(!skin.material.empty());
        CHECK(skin.material[0].color == Vec3(0.5, 0, 0));
    }
}

TEST_CASE("triangles that a blade tore stay away when the body breaks on, in any later stage") {
    const SkinKind kind = SkinKind::mount;
    WorkPiece piece = block({}, kind);
    Aggregate& m = piece.matter;
    break_at(m, -0.09);
    show_matter(piece, true);
    REQUIRE(piece.whole_skin);
    // A path that turns back, and one half drawn away from the other.
    const Vec3 a(0, -1, -1), b(0, 0, -1), c(0.2, -1, -1), up(0, 0, 2);
    CHECK(cut_skins(piece, {{a, b, b + up}, {a, b + up, a + up}, {b, c, c + up}}).has_folded);
    test::sever_plane(m, {0.01, 0, 0}, Vec3::UnitX());
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        if (m.particle_reference.at(p).x() > 0.01) m.particle_position.add(p, {1, 0, 0});
    }
    show_matter(piece, true);
    CHECK(longer_than(0.5, piece.skin, piece.position) == 0);
    CHECK(surface_components(piece.skin).count == 3);
    // What the skin is drawn from anew when more breaks still has them.
    break_at(m, 0.09);
    CHECK(longer_than(0.5, *piece.whole_skin, piece.whole_position) > 0);
    show_matter(piece, true);
    CHECK(longer_than(0.5, piece.skin, piece.position) == 0);
    CHECK(surface_components(piece.skin).count == 4);
}

namespace {

// A plane that a blade sweeps, far beyond a block.
std::vector<std::array<Vec3, 3>> swept(const Vec3& point, const Vec3& normal) {
    const Vec3 across = normal.unitOrthogonal(), up = normal.cross(across);
    const auto corner = [&](double u, double v) -> Vec3 { return point + u * across + v * up; };
    return {{corner(-1, -1), corner(1, -1), corner(1, 1)},
            {corner(-1, -1), corner(1, 1), corner(-1, 1)}};
}

}  // namespace

TEST_CASE("a boundary is cut flat along a blade's plane, and goes on as it was beside it") {
    const bool bent = GENERATE(false, true);
    WorkPiece piece = block({}, SkinKind::boundary);
    Aggregate& m = piece.matter;
    if (bent) bend_round(m);
    show_matter(piece, false);
    const TriMesh before = piece.deformed();
    const TriangleTree outside(before);
    const Vec3 point = box_of(before.position).center() + Vec3(0.01, 0.02, 0);
    for (double tilt : {0.2, 0.9}) {
        INFO(bent << " " << tilt);
        const Vec3 normal(std::cos(tilt), 0.3 * std::sin(tilt), std::sin(tilt));
        WorkPiece cut = piece;
        CHECK(cut_skins(cut, swept(point, normal)).open_parts == 0);
        test::sever_plane(cut.matter, point, normal);
        show_matter(cut, true);
        const TriMesh after = cut.deformed();
        CHECK(test::is_closed(after));
        CHECK(surface_components(after).count > 1);
        CHECK(signed_volume(after) == Approx(signed_volume(before)).epsilon(1e-3));
        double off_plane = 0, off_surface = 0;
        for (std::size_t t = 0; t < after.triangle.size(); ++t) {
            const bool is_cut = after.triangle_material[t] == 1;
            for (int v : after.triangle[t]) {
                const Vec3& at = after.position[v];
                double& off = is_cut ? off_plane : off_surface;
                off = std::max(off, is_cut ? std::abs(normal.normalized().dot(at - point))
                                           : outside.distance(at));
            }
        }
        // What is left of a cell is bent otherwise than all of it was.
        CHECK(off_plane < (bent ? 0.15 : 2e-3) * m.lattice.spacing);
        CHECK(off_surface < (bent ? 0.15 : 1e-2) * m.lattice.spacing);
    }
}

TEST_CASE("a boundary that a blade has cut is made anew once its matter breaks") {
    WorkPiece piece = block({}, SkinKind::boundary);
    cut_skins(piece, swept({0.01, 0, 0}, Vec3::UnitX()));
    test::sever_plane(piece.matter, {0.01, 0, 0}, Vec3::UnitX());
    show_matter(piece, true);
    CHECK(surface_components(piece.skin).count == 2);
    break_at(piece.matter, -0.09);
    show_matter(piece, true);
    CHECK(surface_components(piece.skin).count == 3);
    CHECK(test::is_closed(piece.skin));
    // And what is cut then is severed in it too.
    cut_skins(piece, swept({0.11, 0, 0}, Vec3::UnitX()));
    test::sever_plane(piece.matter, {0.11, 0, 0}, Vec3::UnitX());
    show_matter(piece, true);
    CHECK(surface_components(piece.skin).count == 4);
    CHECK(test::is_closed(piece.skin));
}

TEST_CASE("a boundary is closed where a blade's path folds, and no warning says otherwise") {
    WorkPiece piece = block({}, SkinKind::boundary);
    const Vec3 a(0, -1, -1), b(0, 0, -1), c(0.2, -1, -1), up(0, 0, 2);
    CHECK(!cut_skins(piece, {{a, b, b + up}, {a, b + up, a + up}, {b, c, c + up}}).has_folded);
    test::sever_plane(piece.matter, {0.01, 0, 0}, Vec3::UnitX());
    show_matter(piece, true);
    CHECK(test::is_closed(piece.skin));
    CHECK(surface_components(piece.skin).count == 2);
    CHECK(signed_volume(piece.skin) == Approx(0.008).epsilon(0.01));
}
