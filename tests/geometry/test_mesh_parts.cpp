// SPDX-License-Identifier: GPL-3.0-or-later
// Parts and names in an OBJ, as other programs take them.
#include <sstream>

#include "geometry/mesh_read.h"
#include "geometry/mesh_write.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

namespace swage::test {

namespace {

// A box of each part, from x = `at` on, three long.
TriMesh boxes_at(const std::vector<double>& at) {
    TriMesh mesh;
    for (std::size_t n = 0; n < at.size(); ++n) {
        append(mesh, box_mesh(Vec3(at[n], 0, 0), Vec3(at[n] + 3, 1 + 0.2 * n, 1 + 0.2 * n)));
        mesh.part_name.push_back(fmt::format("part {}", n));
        mesh.triangle_part.resize(mesh.triangle.size(), static_cast<int>(n));
    }
    return mesh;
}

// The words after `o` and `g`, in order, each with its letter.
std::string statements(const std::string& obj) {
    std::string all;
    std::istringstream lines(obj);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("o ") || line.starts_with("g ")) all += line + ";";
    return all;
}

}  // namespace

TEST_CASE("parts that bound something only together are groups, not objects of their own") {
    const Folder folder;
    // The second two cross each other.
    const Repair repair = repair_mesh(boxes_at({-9, 0, 2}));
    REQUIRE(told(repair, "united"));
    write_obj(folder / "a.obj", repair.mesh);
    CHECK(statements(bytes_of(folder / "a.obj")) == "g part_1;g part_2;o part_0;");
    const TriMesh read = read_quietly(folder / "a.obj");
    CHECK(read.part_name == std::vector<std::string>{"part_1", "part_2", "part_0"});
    CHECK(read.triangle.size() == repair.mesh.triangle.size());
    CHECK(signed_volume(read) == Approx(signed_volume(repair.mesh)));

    // Closed by themselves they stay objects, also where they touch.
    write_obj(folder / "b.obj", boxes_at({-9, 0, 3}));
    CHECK(statements(bytes_of(folder / "b.obj")) == "o part_0;o part_1;o part_2;");
    // Also where they share the vertices of an edge.
    TriMesh edge = boxes_at({0, 3});
    for (std::size_t p = 8; p < 16; ++p) {
        Vec3& at = edge.position[p];
        if (at.y() > 1) at.y() = 1;
        at.z() = at.z() > 0 ? 0 : -1;
        for (int q = 0; q < 8; ++q) {
            if (edge.position[q] != at) continue;
            for (Corners& t : edge.triangle) std::replace(t.begin(), t.end(), int(p), q);
        }
    }
    write_obj(folder / "c.obj", edge);
    CHECK(statements(bytes_of(folder / "c.obj")) == "o part_0;o part_1;");
}

TEST_CASE("an object of an OBJ stands in one place, wherever its triangles are in the mesh") {
    const Folder folder;
    TriMesh mesh = boxes_at({0, 9});
    std::swap(mesh.triangle[3], mesh.triangle[17]);
    std::swap(mesh.triangle_part[3], mesh.triangle_part[17]);
    write_obj(folder / "a.obj", mesh);
    CHECK(statements(bytes_of(folder / "a.obj")) == "o part_0;o part_1;");
}

TEST_CASE("pieces of a mesh are objects of an OBJ, called after what they are pieces of") {
    const Folder folder;
    const auto written = [&](const TriMesh& mesh, const std::vector<int>& of_box) {
        std::vector<int> piece;
        for (std::size_t t = 0; t < mesh.triangle.size(); ++t) piece.push_back(of_box[t / 12]);
        write_obj(folder / "a.obj", mesh, objects_of_pieces(mesh, piece, "ball"));
        CHECK(read_quietly(folder / "a.obj").triangle.size() == mesh.triangle.size());
        return statements(bytes_of(folder / "a.obj"));
    };
    TriMesh mesh = boxes_at({0, 9, 18});
    // In one piece, or each part in one of its own, it is as it was.
    CHECK(written(mesh, {0, 0, 0}) == "o part_0;o part_1;o part_2;");
    CHECK(written(mesh, {2, 0, 1}) == "o part_0;o part_1;o part_2;");
    CHECK(written(mesh, {0, 0, 1}) == "o part_0;o part_1;o part_2;");
    // Parts that hold together are the body; a part by itself has its own pieces.
    for (std::size_t t = 24; t < 36; ++t) mesh.triangle_part[t] = 1;
    CHECK(written(mesh, {0, 0, 1}) == "o ball_piece_1;g part_0;g part_1;o ball_piece_2;g part_1;");
    mesh.triangle_part.assign(mesh.triangle.size(), 0);
    for (std::size_t t = 0; t < 12; ++t) mesh.triangle_part[t] = 1;
    CHECK(written(mesh, {0, 2, 1}) ==
          "o part_1;g part_1;o part_0_piece_1;g part_0;o part_0_piece_2;g part_0;");
    mesh.part_name = {"rod"};
    mesh.triangle_part.assign(mesh.triangle.size(), 0);
    CHECK(written(mesh, {2, 1, 0}) == "o rod_piece_1;o rod_piece_2;o rod_piece_3;");
    CHECK(read_quietly(folder / "a.obj").position.size() == mesh.position.size());
    mesh.part_name.clear(), mesh.triangle_part.clear();
    CHECK(written(mesh, {1, 0, 1}) == "o ball_piece_1;o ball_piece_2;");
    CHECK(written(mesh, {0, 0, 0}).empty());
}

TEST_CASE("files that an OBJ names have no blanks in their names") {
    const Folder folder;
    std::filesystem::create_directory(folder / "out");
    TriMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
    box.material.resize(1);
    box.material[0].name = "ash wood";
    box.material[0].texture = folder.write("my image.png", "image");
    box.triangle_material.assign(box.triangle.size(), 0);
    write_obj(folder / "out/hammer head.obj", box);
    CHECK(bytes_of(folder / "out/hammer head.obj").starts_with("mtllib hammer_head.mtl\n"));
    CHECK(bytes_of(folder / "out/hammer_head.mtl").find("map_Kd my_image.png\n") !=
          std::string::npos);
    // It does not take the place of another's.
    TriMesh red = box;
    red.material[0].color = {1, 0, 0};
    red.material[0].texture.clear();
    write_obj(folder / "out/hammer_head.obj", red);
    write_obj(folder / "out/hammer head.obj", box);
    CHECK(read_quietly(folder / "out/hammer_head.obj").material[0].color == Vec3(1, 0, 0));
    const TriMesh read = read_quietly(folder / "out/hammer head.obj");
    CHECK(read.material[0].color == box.material[0].color);
    CHECK(read.material[0].texture.filename() == "my_image.png");
    // Unless its place is its own, whatever stood there before.
    CHECK(library_of("out/hammer head.obj") == "out/hammer_head.mtl");
    write_obj(folder / "out/hammer head.obj", box, {}, LibraryPlace::is_its_own);
    CHECK(read_quietly(folder / "out/hammer head.obj").material[0].color == box.material[0].color);
    CHECK(bytes_of(folder / "out/hammer head.obj").starts_with("mtllib hammer_head.mtl\n"));
}

}  // namespace swage::test
