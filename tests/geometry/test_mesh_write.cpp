// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>

#include "base/error.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "geometry/mesh_write.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::Folder;
using test::read_quietly;

namespace {

void check_equal(const TriMesh& a, const TriMesh& b) {
    CHECK(a.position == b.position);
    CHECK(a.triangle == b.triangle);
    CHECK(a.uv == b.uv);
    CHECK(a.triangle_uv == b.triangle_uv);
    CHECK(a.triangle_polygon == b.triangle_polygon);
    CHECK(a.triangle_material == b.triangle_material);
    CHECK(a.triangle_part == b.triangle_part);
    CHECK(a.triangle_smooth == b.triangle_smooth);
    CHECK(a.part_name == b.part_name);
}

}  // namespace

TEST_CASE("an OBJ read, written and read again is the same mesh, bit for bit") {
    const Folder folder;
    folder.write("p.mtl", "newmtl a\nKd 0.1 0.2 0.3\nPr 0.4\nPm 0.5\nmap_Kd i.png\nnewmtl b\n");
    folder.write("i.png", "image");
    // A prism of a concave hexagon: quads, two hexagons, two parts, two materials, odd numbers.
    std::string text = "mtllib p.mtl\n";
    const double x[6] = {0, 2, 2.1, 1, 1.0 / 3, 0}, y[6] = {0, 0, 3, 1, 3, 2};
    for (int z = 0; z < 2; ++z)
        for (int i = 0; i < 6; ++i) text += fmt::format("v {} {} {}\n", x[i], y[i], z * 0.7);
    text += "vt 0 0\nvt 1 0\nvt 1 0.333333\nvt 0 1\n";
    text += "o side\nusemtl a\n";
    for (int i = 0; i < 6; ++i)
        text +=
            fmt::format("f {}/1 {}/2 {}/3 {}/4\n", i + 1, (i + 1) % 6 + 1, (i + 1) % 6 + 7, i + 7);
    text += "o ends\nusemtl b\nf 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
    const TriMesh first = read_quietly(folder.write("p.obj", text));
    REQUIRE(check_mesh(first).bounds_a_volume());
    CHECK(check_mesh(first).polygons == 8);
    std::filesystem::create_directory(folder / "out");
    write_obj(folder / "out/p.obj", first);
    const TriMesh second = read_quietly(folder / "out/p.obj");
    check_equal(first, second);
    REQUIRE(second.material.size() == 2);
    CHECK(second.material[0].name == "a");
    CHECK(second.material[0].color == Vec3(0.1, 0.2, 0.3));
    CHECK(second.material[0].roughness == 0.4);
    CHECK(second.material[0].metallic == 0.5);
    CHECK(second.material[0].texture == std::filesystem::weakly_canonical(folder / "out/i.png"));
    const std::string bytes = test::bytes_of(folder / "out/p.obj");
    write_obj(folder / "out/q.obj", second);
    CHECK(test::bytes_of(folder / "out/q.obj").substr(13) == bytes.substr(13));  // mtllib aside
}

TEST_CASE("an OBJ holds the texture coordinates and normals that its faces name, no others") {
    const Folder folder;
    TriMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
    smooth_by_crease_angle(mesh);
    mesh.uv = {{9, 9}, {0, 0}, {8, 8}, {1, 0}, {0, 1}, {7, 7}};
    mesh.triangle_uv.assign(mesh.triangle.size(), {3, 1, 4});
    mesh.triangle_uv[2] = {-1, -1, -1};
    for (Corners& c : mesh.triangle_smooth) {
        for (int& g : c) g = 2 * g + 1;
    }
    const int groups = mesh.smooth_group_count;
    mesh.smooth_group_count = 2 * groups + 5;
    write_obj(folder / "u.obj", mesh);
    const std::string text = test::bytes_of(folder / "u.obj");
    const auto lines = [&](const std::string& begin) {
        int count = 0;
        for (auto at = text.find(begin); at != text.npos; at = text.find(begin, at + 1)) ++count;
        return count;
    };
    CHECK(lines("\nvt ") == 3);
    CHECK(lines("\nvn ") == groups);
    const TriMesh read = read_quietly(folder / "u.obj");
    REQUIRE(read.triangle == mesh.triangle);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int is = read.triangle_uv[t][k], was = mesh.triangle_uv[t][k];
            REQUIRE((is < 0) == (was < 0));
            if (was >= 0) CHECK(read.uv[is] == mesh.uv[was]);
        }
    }
}

TEST_CASE("quads and large polygons come out of the writer whole") {
    const Folder folder;
    write_obj(folder / "cube.obj", read_quietly(folder.write("in.obj", test::cube_obj())));
    const std::string text = test::bytes_of(folder / "cube.obj");
    CHECK(text.find("\nf 1/1/1 4/2/2 3/3/3 2/4/4\n") != std::string::npos);
    std::size_t faces = 0;
    for (std::size_t at = 0; (at = text.find("\nf ", at)) != std::string::npos; ++at) ++faces;
    CHECK(faces == 6);
}

TEST_CASE("PLY keeps double precision, polygons, colours and texture seams") {
    const Folder folder;
    TriMesh cube = read_quietly(folder.write("in.obj", test::cube_obj()));
    for (Vec3& p : cube.position) p = p / 3 + Vec3(1e-7, 0, 2.0 / 7);
    for (int i = 0; i < 8; ++i) cube.position_color.push_back({0.25f, 1.0f, 0.125f * i});
    write_ply(folder / "cube.ply", cube);
    const TriMesh again = read_quietly(folder / "cube.ply");
    CHECK(again.position == cube.position);
    CHECK(again.triangle_polygon == cube.triangle_polygon);
    for (int i = 0; i < 8; ++i)
        CHECK((again.position_color[i] - cube.position_color[i]).norm() < 0.006);
    for (std::size_t t = 0; t < cube.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k)
            CHECK(again.uv[again.triangle_uv[t][k]] == cube.uv[cube.triangle_uv[t][k]]);

    // Faces of a cut have none, and those of the skin keep theirs.
    TriMesh cut = cube;
    for (std::size_t t : {0u, 1u}) cut.triangle_uv[t] = {-1, -1, -1};
    write_ply(folder / "cut.ply", cut);
    const TriMesh read = read_quietly(folder / "cut.ply");
    REQUIRE(read.triangle_uv.size() == cut.triangle.size());
    for (std::size_t t = 0; t < cut.triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            if (t < 2) CHECK(read.triangle_uv[t][k] == -1);
            if (t >= 2) CHECK(read.uv[read.triangle_uv[t][k]] == cut.uv[cut.triangle_uv[t][k]]);
        }
    }
    TriMesh bare = cube;
    bare.uv.clear(), bare.triangle_uv.clear();
    write_ply(folder / "bare.ply", bare);
    CHECK(test::bytes_of(folder / "bare.ply").find("property float s") == std::string::npos);

    TriMesh ball = test::ball_mesh(4, 1);  // no seam: coordinates at the vertices
    write_ply(folder / "ball.ply", ball);
    CHECK(test::bytes_of(folder / "ball.ply").find("property float s") != std::string::npos);
    CHECK(read_quietly(folder / "ball.ply").triangle == ball.triangle);
}

TEST_CASE("a PLY has normals where a place shades by one, and none that would round an edge off") {
    const Folder folder;
    TriMesh ball = test::ball_mesh(6, 1);
    smooth_by_crease_angle(ball, 3);
    // Not what the faces tell.
    for (const Vec3& n : smooth_normals(ball, ball.position))
        ball.smooth_normal.push_back((n + Vec3(0, 0, 0.2)).normalized());
    write_ply(folder / "ball.ply", ball);
    CHECK(test::bytes_of(folder / "ball.ply").find("property float nz") != std::string::npos);
    const TriMesh again = read_quietly(folder / "ball.ply");
    CHECK(check_mesh(again).bounds_a_volume());
    REQUIRE(again.triangle == ball.triangle);
    const std::vector<Vec3> was = smooth_normals(ball, ball.position);
    const std::vector<Vec3> is = smooth_normals(again, again.position);
    for (std::size_t t = 0; t < ball.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k)
            CHECK((is[again.triangle_smooth[t][k]] - was[ball.triangle_smooth[t][k]]).norm() <
                  1e-6);

    TriMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
    smooth_by_crease_angle(box);
    write_ply(folder / "box.ply", box);
    CHECK(test::bytes_of(folder / "box.ply").find("nx") == std::string::npos);
    CHECK(read_quietly(folder / "box.ply").smooth_group_count == box.smooth_group_count);
}

TEST_CASE("texture coordinates of a PLY are of the precision that MeshLab reads") {
    const Folder folder;
    TriMesh cube = read_quietly(folder.write("in.obj", test::cube_obj()));
    for (Vec2& uv : cube.uv) uv /= 3;
    TriMesh triangles = cube;
    triangles.triangle_polygon.clear();
    const TriMesh ball = test::ball_mesh(4, 1.0 / 3);
    for (const auto& [mesh, property] :
         {std::pair(triangles, "float texcoord"), std::pair(ball, "float s"),
          std::pair(cube, "double texcoord")}) {  // with polygons it refuses the other
        write_ply(folder / "uv.ply", mesh);
        CHECK(test::bytes_of(folder / "uv.ply").find(property) != std::string::npos);
        const TriMesh again = read_quietly(folder / "uv.ply");
        REQUIRE(again.triangle_uv.size() == mesh.triangle.size());
        for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
            for (int k = 0; k < 3; ++k)
                CHECK((again.uv[again.triangle_uv[t][k]] - mesh.uv[mesh.triangle_uv[t][k]]).norm() <
                      1e-7);
    }
}

TEST_CASE("a PLY holds the texture coordinates of polygons of hundreds of corners") {
    const Folder folder;
    for (const int sides : {100, 127, 128, 200, 255, 256, 300}) {
        std::string text, ends[2] = {"f", "f"};
        for (int n = 0; n < sides; ++n) {
            const double turn = 2 * kPi * n / sides, x = std::cos(turn), y = std::sin(turn);
            text += fmt::format("v {0} {1} 0\nv {0} {1} 1\nvt {0} {1}\nvt {0} {2}\n", x, y, y + 3);
            ends[0] += fmt::format(" {}/{}", 2 * (sides - n) - 1, 2 * (sides - n) - 1);
            ends[1] += fmt::format(" {}/{}", 2 * n + 2, 2 * n + 1);
        }
        for (int n = 0; n < sides; ++n) {
            const int a = 2 * n + 1, b = 2 * ((n + 1) % sides) + 1;
            text += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", a, b, b + 1, a + 1);
        }
        const TriMesh mesh =
            read_quietly(folder.write("a.obj", text + ends[0] + "\n" + ends[1] + "\n"));
        write_ply(folder / "a.ply", mesh);
        const TriMesh read = read_quietly(folder / "a.ply");
        CAPTURE(sides);
        CHECK(read.position == mesh.position);
        REQUIRE(read.triangle == mesh.triangle);
        for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
            for (int k = 0; k < 3; ++k)
                CHECK(read.uv[read.triangle_uv[t][k]] == mesh.uv[mesh.triangle_uv[t][k]]);
    }
}

TEST_CASE("a gloss is written for programs of either kind") {
    const Folder folder;
    TriMesh cube = test::box_mesh({0, 0, 0}, {1, 1, 1});
    cube.material.resize(1);
    cube.material[0].roughness = 0.5;
    cube.material[0].metallic = 0.25;
    write_obj(folder / "a.obj", cube);
    const std::string library = test::bytes_of(folder / "a.mtl");
    CHECK(library.find("\nNs 6\nPr 0.5\nPm 0.25\n") != std::string::npos);  // 2 / r^2 - 2
}

TEST_CASE("each face of a PLY keeps its texture, and those without have none") {
    const Folder folder;
    TriMesh cube = read_quietly(folder.write("in.obj", test::cube_obj()));
    cube.material.assign(3, {});
    for (int m : {0, 2}) {  // the second material has no texture
        const std::string name = fmt::format("image_{}.png", m);
        cube.material[m].texture = folder.write(name, name);
    }
    cube.triangle_material.clear();
    for (std::size_t t = 0; t < cube.triangle.size(); ++t)
        cube.triangle_material.push_back(static_cast<int>(t / 2 % 3));
    std::filesystem::create_directory(folder / "out");
    write_ply(folder / "out/cube.ply", cube);
    const TriMesh again = read_quietly(folder / "out/cube.ply");
    REQUIRE(again.triangle_material.size() == cube.triangle.size());
    CHECK(again.material.size() == 3);
    for (std::size_t t = 0; t < cube.triangle.size(); ++t) {
        INFO("triangle " << t);
        CHECK(again.material[again.triangle_material[t]].texture.filename() ==
              cube.material[cube.triangle_material[t]].texture.filename());
    }
}

TEST_CASE("a face without coordinates among those that have them has no texture in a PLY") {
    const Folder folder;
    TriMesh cut = read_quietly(folder.write("in.obj", test::cube_obj()));
    cut.material.assign(2, {});
    cut.material[0].texture = folder.write("image.png", "image");
    cut.triangle_material.assign(cut.triangle.size(), 0);
    for (const std::size_t t : {4u, 5u}) cut.triangle_uv[t] = {-1, -1, -1};
    for (const std::size_t t : {8u, 9u}) cut.triangle_material[t] = 1;
    std::filesystem::create_directory(folder / "out");
    write_ply(folder / "out/cut.ply", cut);
    const std::string bytes = test::bytes_of(folder / "out/cut.ply");
    CHECK(bytes.find("property int texnumber\n") != std::string::npos);
    // The same from one who names an image and leaves the choice to the coordinates.
    const auto file =
        folder.write("out/other.ply",
                     "ply\nformat ascii 1.0\ncomment TextureFile image.png\nelement vertex 4\n"
                     "property float x\nproperty float y\nproperty float z\nelement face 2\n"
                     "property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
                     "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2 6 0 0 1 0 0 1\n3 0 3 1 0\n");
    const auto textured = [](const TriMesh& mesh, std::size_t t) {
        return !mesh.material[mesh.triangle_material[t]].texture.empty();
    };
    const TriMesh again = read_quietly(folder / "out/cut.ply");
    REQUIRE(again.triangle_material.size() == cut.triangle.size());
    for (std::size_t t = 0; t < cut.triangle.size(); ++t)
        CHECK(textured(again, t) == (t / 2 != 2 && t / 2 != 4));
    const TriMesh other = read_quietly(file);
    CHECK(textured(other, 0));
    CHECK(!textured(other, 1));

    // Where all have theirs, nothing is to be chosen.
    cut.triangle_uv = read_quietly(folder / "in.obj").triangle_uv;
    cut.triangle_material.assign(cut.triangle.size(), 0);
    write_ply(folder / "out/whole.ply", cut);
    CHECK(test::bytes_of(folder / "out/whole.ply").find("texnumber") == std::string::npos);
    CHECK(textured(read_quietly(folder / "out/whole.ply"), 4));
}

TEST_CASE("of several textures of a PLY whose faces choose none the first is taken, and said") {
    const Folder folder;
    for (const char* name : {"a.png", "b.png"}) folder.write(name, name);
    const auto file =
        folder.write("one.ply",
                     "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b.png\n"
                     "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                     "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                     "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    std::vector<std::string> finding;
    const TriMesh mesh = read_mesh(file, {}, &finding);
    CHECK(mesh.material[mesh.triangle_material[0]].texture.filename() == "a.png");
    REQUIRE(finding.size() == 1);
    CHECK(finding[0].find("2 textures are named") != std::string::npos);
}

TEST_CASE("a PLY shows the colour of faces that take none of the mesh, inside of their rim") {
    TriMesh mesh;
    mesh.position = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, 0}, {0, 0, -1}};
    mesh.triangle = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
    mesh.position_color.assign(5, {0.F, 1.F, 0.F});
    mesh.material = {{.name = "coat"}, {.name = "cut", .color = {1, 0, 0}, .takes_colors = false}};
    mesh.triangle_material = {1, 1, 1, 0, 0, 0};
    const Folder folder;
    write_ply(folder / "a.ply", mesh);
    const TriMesh read = read_quietly(folder / "a.ply");
    REQUIRE(read.position_color.size() == 5);
    for (std::size_t v = 0; v < 5; ++v) {
        INFO(v);
        CHECK((read.position_color[v] - Eigen::Vector3f(v == 3, v != 3, 0)).norm() < 1e-6);
    }
}

TEST_CASE("vertex colours of a PLY look as their materials make them, read again") {
    TriMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
    mesh.position_color.assign(8, {0.8F, 0.8F, 0.4F});
    mesh.material = {{.name = "paint", .color = {0.1, 0.8, 0.1}}};
    mesh.triangle_material.assign(mesh.triangle.size(), 0);
    const Folder folder;
    const bool has_image = GENERATE(false, true);
    if (has_image) {
        mesh.material[0].texture = folder.write("image.png", "image");
        mesh.uv = {{0.5, 0.5}};
        mesh.triangle_uv.assign(mesh.triangle.size(), {0, 0, 0});
    }
    std::filesystem::create_directories(folder / "out");
    write_ply(folder / "out/a.ply", mesh);
    const TriMesh read = read_quietly(folder / "out/a.ply");
    REQUIRE(read.position_color.size() == 8);
    REQUIRE(read.material.size() == (has_image ? 1 : 0));
    const Vec3 factor = has_image ? read.material[0].color : SurfaceMaterial().color;
    for (const Eigen::Vector3f& color : read.position_color) {
        const Vec3 seen = factor.cwiseProduct(color.cast<double>());
        CHECK((seen - Vec3(0.08, 0.64, 0.04)).cwiseAbs().maxCoeff() < 3e-3);  // 8 bit
    }
}

TEST_CASE("a texture without an ending gets that of its kind") {
    TriMesh box = test::box_mesh({0, 0, 0}, {1, 2, 3});
    const Folder folder;
    box.material.push_back({.name = "m"});
    box.material[0].texture = folder.write("hide", "\x89PNG\r\n\x1a\n");
    box.triangle_material.assign(box.triangle.size(), 0);
    std::filesystem::create_directories(folder / "out");
    write_obj(folder / "out/b.obj", box);
    CHECK(test::bytes_of(folder / "out/hide.png") == "\x89PNG\r\n\x1a\n");
}

TEST_CASE("vertex colours survive an OBJ") {
    const Folder folder;
    TriMesh box = test::box_mesh({0, 0, 0}, {1, 2, 3});
    for (int i = 0; i < 8; ++i) box.position_color.push_back({0.1f * i, 0.5f, 1 - 0.1f * i});
    write_obj(folder / "box.obj", box);
    const TriMesh again = read_quietly(folder / "box.obj");
    REQUIRE(again.position_color.size() == 8);
    for (int i = 0; i < 8; ++i)
        CHECK((again.position_color[i] - box.position_color[i]).norm() < 1e-5);
}

TEST_CASE("exports beside each other share equal textures and never overwrite others") {
    const Folder folder;
    TriMesh box = test::box_mesh({0, 0, 0}, {1, 2, 3});
    box.material.push_back({});
    box.triangle_material.assign(box.triangle.size(), 0);
    std::filesystem::create_directories(folder / "a");
    std::filesystem::create_directories(folder / "out");
    folder.write("a/t.png", "one");
    folder.write("out/t.png", "another");
    box.material[0].texture = folder / "a/t.png";
    write_obj(folder / "out/f1.obj", box);
    write_obj(folder / "out/f2.obj", box);
    CHECK(test::bytes_of(folder / "out/t.png") == "another");
    CHECK(test::bytes_of(folder / "out/t_2.png") == "one");
    CHECK(!std::filesystem::exists(folder / "out/t_3.png"));
    CHECK(read_quietly(folder / "out/f2.obj").material[0].texture.filename() == "t_2.png");
    std::filesystem::create_directories(folder / "in/t.png");  // no file, and somebody's
    write_obj(folder / "in/f.obj", box);
    CHECK(test::bytes_of(folder / "in/t_2.png") == "one");
}

TEST_CASE("a mesh that cannot be written leaves no library and no picture, but those of others") {
    const Folder folder;
    TriMesh mesh = test::ball_mesh(3, 0.5);
    mesh.material.resize(1);
    mesh.material[0].name = "hide";
    mesh.material[0].embedded_texture = std::make_shared<const std::string>("image");
    for (const char* name : {"ball.obj", "ball.ply"}) {
        std::filesystem::create_directory(folder / name);
        const auto write = [&] {
            std::string(name) == "ball.obj" ? write_obj(folder / name, mesh)
                                            : write_ply(folder / name, mesh);
        };
        CHECK_THROWS_AS(write(), Error);
        std::filesystem::remove(folder / name);
        CHECK(std::filesystem::is_empty(folder / "."));
        std::filesystem::create_directory(folder / name);
        const auto own = folder.write("hide.img", "image");
        CHECK_THROWS_AS(write(), Error);
        CHECK(std::filesystem::exists(own));
        std::filesystem::remove(own);
        const auto library = folder.write("ball.mtl", "newmtl other\n");
        CHECK_THROWS_AS(write(), Error);
        CHECK(std::filesystem::exists(library));
        std::filesystem::remove(library);
        std::filesystem::remove(folder / name);
    }
}

TEST_CASE("a mesh with bad indices or a folder that is not there is an output error") {
    const Folder folder;
    TriMesh box = test::box_mesh({0, 0, 0}, {1, 2, 3});
    const auto code = [&](const std::filesystem::path& file) {
        try {
            write_obj(file, box);
        } catch (const Error& error) {
            return error.code();
        }
        return ExitCode::done;
    };
    CHECK(code(folder / "no/where.obj") == ExitCode::output);
    box.triangle[0][0] = 8;
    CHECK(code(folder / "bad.obj") == ExitCode::output);
    CHECK(!std::filesystem::exists(folder / "bad.obj"));
}

TEST_CASE("a hundred thousand triangles are written in well under a second") {
    const Folder folder;
    TriMesh ball = test::ball_mesh(160, 1);
    smooth_by_crease_angle(ball, 0.7);
    const auto started = std::chrono::steady_clock::now();
    write_obj(folder / "ball.obj", ball);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - started;
    const auto read_started = std::chrono::steady_clock::now();
    const TriMesh again = read_quietly(folder / "ball.obj");
    const std::chrono::duration<double> read_took = std::chrono::steady_clock::now() - read_started;
    UNSCOPED_INFO(ball.triangle.size() << " triangles: written in " << took.count()
                                       << " s, read in " << read_took.count() << " s");
    CHECK(again.triangle == ball.triangle);
    CHECK(took.count() < 5);  // the bench holds the real bar
}
