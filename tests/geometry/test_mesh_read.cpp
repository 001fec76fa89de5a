// SPDX-License-Identifier: GPL-3.0-or-later
// What a good file holds arrives.
#include <cstring>
#include <set>

#include "base/error.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "geometry/mesh_write.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::Folder;
using test::raw;
using test::read_quietly;
using test::replaced;

namespace {

const char* kTetOff =
    "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

// One triangle pair (a unit square) under a node that mirrors x and moves by (10, 0, 0).
std::string square_gltf() {
    std::string buffer;
    for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f})
        buffer += raw(v);  // positions, 48 bytes
    for (const float v : {0.f, 1.f, 1.f, 1.f, 1.f, 0.f, 0.f, 0.f}) buffer += raw(v);  // uv, 32
    for (const std::uint16_t i : {0, 1, 2, 0, 2, 3}) buffer += raw(i);                // 12
    return buffer;
}

const char* kGltfScene = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"name":"board","mesh":0,"translation":[10,0,0],"scale":[-1,1,1]}],
"meshes":[{"name":"square","primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":0}]}],
"materials":[{"name":"paint","pbrMetallicRoughness":{"baseColorFactor":[0.25,0.5,0.75,1],
"metallicFactor":0.125,"roughnessFactor":0.375,"baseColorTexture":{"index":0}}}],
"textures":[{"source":0}],"images":[IMAGE],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},
{"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":32},
{"buffer":0,"byteOffset":80,"byteLength":12},{"buffer":0,"byteOffset":92,"byteLength":8}],
"buffers":[{"byteLength":100URI}]})";

std::string square_glb() {
    std::string json = replaced(kGltfScene, "IMAGE", R"({"bufferView":3,"mimeType":"image/png"})");
    json = replaced(json, "URI", "");
    while (json.size() % 4 != 0) json += ' ';
    const std::string buffer = square_gltf() + std::string("\x89PNG1234", 8);
    return "glTF" + raw<std::uint32_t>(2) +
           raw<std::uint32_t>(static_cast<std::uint32_t>(28 + json.size() + buffer.size())) +
           raw<std::uint32_t>(static_cast<std::uint32_t>(json.size())) + "JSON" + json +
           raw<std::uint32_t>(static_cast<std::uint32_t>(buffer.size())) + std::string("BIN\0", 4) +
           buffer;
}

void check_square(const TriMesh& mesh) {
    REQUIRE(mesh.triangle.size() == 2);
    REQUIRE(mesh.position.size() == 4);
    const Box box = box_of(mesh.position);
    CHECK((box.low - Vec3(9, 0, 0)).norm() < 1e-6);
    CHECK((box.high - Vec3(10, 1, 0)).norm() < 1e-6);
    // Mirrored: the winding was turned, so the square still faces +z.
    for (const Corners& t : mesh.triangle) {
        const Vec3 n = (mesh.position[t[1]] - mesh.position[t[0]])
                           .cross(mesh.position[t[2]] - mesh.position[t[0]]);
        CHECK(n.z() > 0.5);
    }
    REQUIRE(mesh.material.size() == 1);
    CHECK(mesh.material[0].name == "paint");
    CHECK((mesh.material[0].color - Vec3(0.25, 0.5, 0.75)).norm() < 1e-6);
    CHECK(mesh.material[0].metallic == Approx(0.125));
    CHECK(mesh.material[0].roughness == Approx(0.375));
    REQUIRE(mesh.part_name.size() == 1);
    CHECK(mesh.part_name[0] == "board");
    // The first corner of the file's square: uv (0, 1) counted from the top is (0, 0) from below.
    for (std::size_t t = 0; t < 2; ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3& p = mesh.position[mesh.triangle[t][k]];
            const Vec2& uv = mesh.uv[mesh.triangle_uv[t][k]];
            CHECK(uv.x() == Approx(10 - p.x()).margin(1e-6));
            CHECK(uv.y() == Approx(p.y()).margin(1e-6));
        }
}

}  // namespace

TEST_CASE("an OBJ cube of quads keeps quads, order, welds and texture corners") {
    const Folder folder;
    const TriMesh cube = read_quietly(folder.write("cube.obj", test::cube_obj()));
    CHECK(cube.position.size() == 8);
    CHECK(cube.triangle.size() == 12);
    CHECK(cube.uv.size() == 4);
    CHECK(cube.position[6] == Vec3(1, 1, 1));
    CHECK(signed_volume(cube) == Approx(1));
    CHECK(surface_area(cube) == Approx(6));
    CHECK(cube.smooth_group_count == 24);  // every edge is a crease
    const MeshReport report = check_mesh(cube);
    CHECK(report.polygons == 6);
    CHECK(report.watertight);
    CHECK(report.manifold);
    CHECK(report.bounds_a_volume());
    CHECK(report.finding.empty());
    CHECK(summary_line(report) ==
          "8 vertices, 12 triangles (6 polygons), 1 component, texture coordinates, closed, "
          "volume 1 m3, box 1 x 1 x 1 m");
}

TEST_CASE(
    "an OBJ file's oddities are read: byte order mark, CRLF, negative indices, continuation") {
    const Folder folder;
    const TriMesh mesh = read_quietly(folder.write(
        "odd.OBJ",
        "\xef\xbb\xbf# comment\r\nv 0 0 0\r\nv 1 0 0 # here\r\nv 0 1 \\\r\n 0\r\nv +0 0 1e0\r\n"
        "v -0 0 1\r\nf -5 -3 -4\r\nf 1 2 4\r\nf 1 5 3\r\nf 2 3 4\r\nf 1 2\r\nl 1 2\r\np 1"));
    CHECK(mesh.position.size() == 4);  // two stand at one place
    CHECK(mesh.triangle.size() == 4);
    CHECK(check_mesh(mesh).bounds_a_volume());
    CHECK(signed_volume(mesh) == Approx(1.0 / 6));
}

TEST_CASE("an OBJ file's comment ends at its line's end, whatever it ends with") {
    const Folder folder;
    const TriMesh mesh = read_quietly(folder.write(
        "c.obj",
        "# C:\\m\\\nv 0 0 0\nv 1 0 0 # D:\\\nv 0 1 \\\n0 # \\\nv 0 0 1\n# \\\r\nf 1 3 2\n#\\\n"
        "f 1 2 4\nf 1 4 3 # \\\nf 2 3 4\n"));
    CHECK(mesh.position.size() == 4);
    CHECK(mesh.triangle.size() == 4);
    CHECK(signed_volume(mesh) == Approx(1.0 / 6));
}

TEST_CASE("OBJ materials arrive with colours, shine and images, also from awkward names") {
    const Folder folder;
    folder.write(
        "two words.mtl",
        "newmtl red paint\nKd 0.5 0.25 0\nPr 0.3\nPm 0.7\nmap_Kd -s 1 1 -o 0 0 0 -clamp on "
        "im age.png\nmap_Bump x.png\nnewmtl bare\nKd 1 1 1\nnewmtl gone\nmap_Kd no.png\n");
    folder.write("im age.png", "png");
    std::vector<std::string> finding;
    const TriMesh mesh = read_mesh(
        folder.write(
            "m.obj",
            "mtllib two words.mtl\no first part\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red paint\n"
            "f 1 2 3\nusemtl gone\nf 1 2 3\no second\nusemtl bare\nf 1 3 2\n"),
        {}, &finding);
    REQUIRE(mesh.material.size() == 3);
    CHECK(mesh.material[0].name == "red paint");
    CHECK(mesh.material[0].color == Vec3(0.5, 0.25, 0));
    CHECK(mesh.material[0].roughness == 0.3);
    CHECK(mesh.material[0].metallic == 0.7);
    CHECK(mesh.material[0].texture.filename() == "im age.png");
    CHECK(mesh.material[0].texture.is_absolute());
    CHECK(mesh.material[1].texture.empty());
    CHECK(mesh.triangle_material == std::vector<int>{0, 1, 2});
    CHECK(mesh.part_name == std::vector<std::string>{"first part", "second"});
    CHECK(mesh.triangle_part == std::vector<int>{0, 0, 1});
    CHECK(finding.size() == 2);  // the map_Bump, the missing image
}

TEST_CASE("a material that no library of an OBJ defines is told") {
    const Folder folder;
    folder.write("m.mtl", "newmtl known\nKd 1 0 0\n");
    const auto findings = [&](const std::string& head, const std::string& uses) {
        std::vector<std::string> finding;
        read_mesh(folder.write("m.obj", head + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" + uses), {},
                  &finding);
        return finding;
    };
    CHECK(findings("mtllib m.mtl\n", "usemtl known\nf 1 3 2\n").empty());
    const auto misspelt =
        findings("mtllib m.mtl\n", "usemtl Known\nf 1 3 2\nusemtl known\nf 1 3 2\n");
    REQUIRE(misspelt.size() == 1);
    CHECK(misspelt[0] == "no material file defines the material 'Known': left grey");
    CHECK(findings("", "usemtl a\nf 1 3 2\nusemtl b\nf 1 2 3\n") ==
          std::vector<std::string>{"no material file defines the materials 'a', 'b': left grey"});
    // Where the library is missing, that says it all.
    CHECK(findings("mtllib none.mtl\n", "usemtl a\nf 1 3 2\n").size() == 1);
}

TEST_CASE("normals of a file decide which corners shade alike") {
    const Folder folder;
    // Two triangles at a right angle: by the crease rule sharp, here one normal at the edge.
    const std::string points =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 0 -1 0\nvn 0 -1 1\n";
    const TriMesh soft =
        read_quietly(folder.write("soft.obj", points + "f 1//3 2//3 3//1\nf 1//3 4//2 2//3\n"));
    CHECK(soft.smooth_group_count == 4);
    const TriMesh sharp =
        read_quietly(folder.write("sharp.obj", points + "f 1//1 2//1 3//1\nf 1//2 4//2 2//2\n"));
    CHECK(sharp.smooth_group_count == 6);
    const TriMesh none = read_quietly(folder.write("none.obj", points + "f 1 2 3\nf 1 4 2\n"));
    CHECK(none.smooth_group_count == 6);
}

TEST_CASE("concave and large polygons keep their area and are cut without overlap") {
    const Folder folder;
    // A comb with 40 teeth: 1 x 1 back, teeth of 1/80 width and height 1.
    std::string text;
    int count = 0;
    double area = 1;
    const auto point = [&](double x, double y) {
        text += fmt::format("v {} {} 0.5\n", x, y);
        ++count;
    };
    point(0, -1);
    point(1, -1);
    for (int tooth = 39; tooth >= 0; --tooth) {
        const double x = tooth / 40.0;
        point(x + 0.025, 0);
        point(x + 0.0125, 0);
        point(x + 0.0125, 1);
        point(x, 1);
        area += 0.0125;
    }
    text += "f";
    for (int i = 1; i <= count; ++i) text += fmt::format(" {}", i);
    const TriMesh comb = read_quietly(folder.write("comb.obj", text + "\n"));
    CHECK(comb.triangle.size() == static_cast<std::size_t>(count) - 2);
    CHECK(surface_area(comb) == Approx(area));
    for (const Corners& t : comb.triangle)
        CHECK((comb.position[t[1]] - comb.position[t[0]])
                  .cross(comb.position[t[2]] - comb.position[t[0]])
                  .z() >= 0);
    CHECK(check_mesh(comb).polygons == 1);
    // A quad with a dent must be cut through the dent.
    const TriMesh dart =
        read_quietly(folder.write("dart.obj", "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\n"));
    CHECK(surface_area(dart) == Approx(4));
}

TEST_CASE("PLY arrives from text and both byte orders, with colours and texture coordinates") {
    const Folder folder;
    const std::string header =
        "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "property float s\nproperty float t\nelement face 2\n"
        "property list uchar int vertex_indices\nelement extra 1\nproperty int a\nend_header\n";
    const std::string ascii = "ply\nformat ascii 1.0\ncomment TextureFile skin.png\n" + header +
                              "0 0 0 255 0 0 0 0\n1 0 0 0 255 0 1 0\n1 1 0 0 0 255 1 1\n"
                              "0 1 0 255 255 255 0 1\n4 0 1 2 3\n3 0 3 2\n7\n";
    std::string little = "ply\nformat binary_little_endian 1.0\n" + header;
    std::string big = "ply\nformat binary_big_endian 1.0\n" + header;
    const auto put = [&](auto value) {
        std::string bytes = raw(value);
        little += bytes;
        std::reverse(bytes.begin(), bytes.end());
        big += bytes;
    };
    const float place[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const unsigned char color[4][3] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}};
    for (int i = 0; i < 4; ++i) {
        for (const float f : {place[i][0], place[i][1], 0.f}) put(f);
        for (const unsigned char c : color[i]) put(c);
        put(place[i][0]);
        put(place[i][1]);
    }
    put(static_cast<unsigned char>(4));
    for (const int i : {0, 1, 2, 3}) put(i);
    put(static_cast<unsigned char>(3));
    for (const int i : {0, 3, 2}) put(i);
    put(7);
    folder.write("skin.png", "x");
    for (const auto& [name, bytes] :
         {std::pair("a.ply", ascii), std::pair("l.ply", little), std::pair("b.ply", big)}) {
        CAPTURE(name);
        std::vector<std::string> finding;
        const TriMesh mesh = read_mesh(folder.write(name, bytes), {}, &finding);
        REQUIRE(mesh.position.size() == 4);
        CHECK(mesh.triangle.size() == 3);
        CHECK(check_mesh(mesh).polygons == 2);
        CHECK(mesh.position_color[1] == Eigen::Vector3f(0, 1, 0));
        CHECK(mesh.uv[mesh.triangle_uv[0][0]] == Vec2(0, 0));
        CHECK(finding.size() == 1);  // "extra"
        if (std::string(name) == "a.ply") {
            REQUIRE(mesh.material.size() == 1);
            CHECK(mesh.material[0].texture.filename() == "skin.png");
        }
    }
}

TEST_CASE("triangle strips in a PLY become all their triangles, turned alike") {
    const Folder folder;
    // A strip over a 3 x 2 ladder, a restart, and a second strip with a turning repeat.
    const std::string header =
        "element vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
        "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    const std::string text = "ply\nformat ascii 1.0\n" + header +
                             "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n"
                             "13 1 0 3 2 5 4 -1 1 0 0 3 3 -1\n";
    std::string binary = "ply\nformat binary_little_endian 1.0\n" + header;
    for (const float v : {0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0, 2, 1, 0})
        binary += raw<float>(v);
    for (const int i : {13, 1, 0, 3, 2, 5, 4, -1, 1, 0, 0, 3, 3, -1}) binary += raw(i);
    for (const auto& [name, bytes] : {std::pair("t.ply", text), std::pair("b.ply", binary)}) {
        const TriMesh mesh = read_quietly(folder.write(name, bytes));
        REQUIRE(mesh.triangle.size() == 4);
        CHECK(surface_area(mesh) == Approx(2));
        for (const Corners& t : mesh.triangle)
            CHECK((mesh.position[t[1]] - mesh.position[t[0]])
                      .cross(mesh.position[t[2]] - mesh.position[t[0]])
                      .z() > 0);
    }
}

TEST_CASE("OFF is read, and one whose faces name missing vertices is refused") {
    const Folder folder;
    const TriMesh tet = read_quietly(folder.write("t.off", kTetOff));
    CHECK(signed_volume(tet) == Approx(1.0 / 6));
    CHECK_THROWS_AS(read_quietly(folder.write("a.off", replaced(kTetOff, "3 1 2 3", "3 1 2 9"))),
                    Error);
    CHECK_THROWS_AS(read_quietly(folder.write("b.off", replaced(kTetOff, "3 1 2 3\n", ""))), Error);
}

TEST_CASE("glTF and GLB arrive with node transforms, physical materials and images") {
    const Folder folder;
    const std::string buffer = square_gltf() + "padding!";
    folder.write("data.bin", buffer);
    folder.write("my image.png", "png");
    std::string text = replaced(kGltfScene, "IMAGE", R"({"uri":"my%20image.png"})");
    text = replaced(text, "URI", R"(,"uri":"data.bin")");
    const TriMesh outside = read_quietly(folder.write("square.gltf", text));
    check_square(outside);
    CHECK(outside.material[0].texture.filename() == "my image.png");

    const TriMesh inside = read_quietly(folder.write("square.glb", square_glb()));
    check_square(inside);
    REQUIRE(inside.material[0].embedded_texture != nullptr);
    CHECK(*inside.material[0].embedded_texture == std::string("\x89PNG1234", 8));

    // The image goes out as a file beside the OBJ, and is found again.
    std::filesystem::create_directory(folder / "out");
    write_obj(folder / "out/square.obj", inside);
    const TriMesh again = read_quietly(folder / "out/square.obj");
    CHECK(again.material[0].texture.filename() == "paint.png");
    CHECK(test::bytes_of(again.material[0].texture) == std::string("\x89PNG1234", 8));
}

TEST_CASE("a glTF whose faces name missing vertices is refused, not read with a hole") {
    const Folder folder;
    std::string buffer = square_gltf() + "padding!";
    buffer[80 + 2] = 9;  // an index
    folder.write("data.bin", buffer);
    std::string text = replaced(kGltfScene, "IMAGE", R"({"uri":"none.png"})");
    text = replaced(text, "URI", R"(,"uri":"data.bin")");
    CHECK_THROWS_AS(read_quietly(folder.write("square.gltf", text)), Error);
}

TEST_CASE("DAE arrives scaled by its unit and turned to its axes") {
    const Folder folder;
    const TriMesh mesh = read_quietly(folder.write("t.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g" name="wedge"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 0 100 0 0 0 100</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="4"><input semantic="VERTEX" source="#v" offset="0"/><vcount>3 3 3 3</vcount>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)"));
    CHECK(mesh.position.size() == 4);
    CHECK(signed_volume(mesh) == Approx(1.0 / 6));
}

TEST_CASE("parts are called by their objects, whatever materials and instances a mesh has") {
    const Folder folder;
    const std::string primitive =
        R"({"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":0})";
    const auto parts_of = [&](const std::string& nodes, const std::string& mesh_name) {
        std::string text = replaced(kGltfScene, "IMAGE", R"({"uri":"image.png"})");
        text = replaced(text, "URI", R"(,"uri":"square.bin")");
        text = replaced(text, R"("name":"square",)", mesh_name);
        text = replaced(text, primitive, primitive + "," + primitive);
        const std::size_t from = text.find(R"([{"name":"board")");
        text.replace(from, text.find("]}],", from) + 3 - from, nodes);
        text = replaced(text, R"("nodes":[0])", R"("nodes":[0,1])");
        return read_quietly(folder.write("square.gltf", text)).part_name;
    };
    folder.write("square.bin", square_gltf() + "padding!");
    folder.write("image.png", "png");
    using Names = std::vector<std::string>;
    const std::string named = R"("name":"square-1",)";
    CHECK(parts_of(R"([{"name":"left","mesh":0},{"name":"right","mesh":0}])", named) ==
          Names{"left", "right"});
    CHECK(parts_of(R"([{"name":"left","mesh":0},{"mesh":0}])", named) == Names{"left", "square-1"});
    CHECK(parts_of(R"([{"mesh":0},{"mesh":0}])", named) == Names{"square-1", "square-1.2"});
    CHECK(parts_of(R"([{"mesh":0},{}])", "") == Names{});
}

TEST_CASE("an image lies where a glTF material scales, shifts and turns it to") {
    const Folder folder;
    // From above, as glTF counts: (u, v) goes to shift + turned (2 u, 3 v), a quarter to the left
    // as the image is looked at.
    std::string gltf = replaced(kGltfScene, "IMAGE", R"({"uri":"image.png"})");
    gltf = replaced(gltf, "URI", R"(,"uri":"square.bin")");
    gltf = replaced(gltf, R"({"asset")", R"({"extensionsUsed":["KHR_texture_transform"],"asset")");
    gltf = replaced(gltf, R"("baseColorTexture":{"index":0})",
                    R"("baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":
                    {"scale":[2,3],"offset":[0.5,0.25],"rotation":1.5707963267948966}}})");
    folder.write("square.bin", square_gltf() + "padding!");
    folder.write("image.png", "png");
    std::vector<std::string> finding;
    const TriMesh square = read_mesh(folder.write("square.gltf", gltf), {}, &finding);
    CHECK(finding.empty());
    for (std::size_t t = 0; t < 2; ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3& p = square.position[square.triangle[t][k]];
            const Vec2 from_above(10 - p.x(), 1 - p.y());
            const Vec2 expected(0.5 + 3 * from_above.y(), 0.25 - 2 * from_above.x());
            const Vec2& uv = square.uv[square.triangle_uv[t][k]];
            CHECK((Vec2(uv.x(), 1 - uv.y()) - expected).norm() < 1e-5);
        }
}

TEST_CASE("the same file read twice gives the same mesh") {
    const Folder folder;
    const auto file = folder.write("square.glb", square_glb());
    const TriMesh a = read_quietly(file), b = read_quietly(file);
    CHECK(a.position == b.position);
    CHECK(a.triangle == b.triangle);
    CHECK(a.triangle_smooth == b.triangle_smooth);
}

TEST_CASE("Spot the cow is read whole, with the image that her file does not name") {
    const std::filesystem::path folder = SWAGE_SOURCE_DIR "/../shared/data/meshes";
    if (!std::filesystem::exists(folder / "spot_triangulated.obj")) {
        WARN("skipped: " << folder.string() << " is absent");
        return;
    }
    std::vector<std::string> finding;
    const TriMesh spot = read_mesh(folder / "spot_triangulated.obj", {}, &finding);
    const MeshReport report = check_mesh(spot);
    CHECK(report.vertices == 2930);
    CHECK(report.triangles == 5856);
    CHECK(report.components == 1);
    CHECK(report.bounds_a_volume());
    CHECK(report.manifold);
    REQUIRE(spot.material.size() == 1);
    CHECK(spot.material[0].texture.filename() == "spot_texture.png");
    CHECK(finding.size() == 1);
    const TriMesh quads = read_mesh(folder / "spot_quadrangulated.obj", {}, &finding);
    CHECK(check_mesh(quads).polygons == 2928);
    CHECK(signed_volume(quads) == Approx(signed_volume(spot)).epsilon(0.01));
}

TEST_CASE(
    "an OBJ file without normals is smooth within its groups, and where it says nothing by "
    "angles") {
    const Folder folder;
    // A drum of 24 sides, 15 degrees from one to the next.
    constexpr int kSides = 24;
    std::string places;
    for (int n = 0; n < 2 * kSides; ++n) {
        const double angle = 2 * kPi / kSides * (n % kSides);
        places += fmt::format("v {} {} {}\n", std::cos(angle), std::sin(angle), n / kSides);
    }
    const auto groups = [&](const std::string& sides, const std::string& caps,
                            const std::string& normal = {}) {
        std::string text = places + (normal.empty() ? "" : "vn 0 0 1\n") + sides;
        for (int n = 1; n <= kSides; ++n)
            text += fmt::format("f {0}{4} {1}{4} {2}{4} {3}{4}\n", n, n % kSides + 1,
                                n % kSides + 1 + kSides, n + kSides, normal);
        std::string low = "f", high = "f";
        for (int n = 1; n <= kSides; ++n) {
            low += fmt::format(" {}{}", kSides + 1 - n, normal);
            high += fmt::format(" {}{}", kSides + n, normal);
        }
        const TriMesh mesh = read_quietly(folder.write("a.obj", text + caps + low + "\n" + high));
        REQUIRE(mesh.triangle.size() == 4 * kSides - 4);
        return mesh.smooth_group_count;
    };
    const int creased = 4 * kSides, facets = 6 * kSides, round = 2 * kSides;
    CHECK(groups("", "") == creased);
    CHECK(groups("s off\n", "") == facets);
    CHECK(groups("s 0\n", "") == facets);
    CHECK(groups("", "s off\n") == facets);  // off until told
    CHECK(groups("s 1\n", "s 2\n") == creased);
    CHECK(groups("s 1 # sides\n", "s 1\n") == round);
    CHECK(groups("s 3\n", "s off\n") == creased);
    CHECK(groups("s off\n", "", "//1") == round);  // normals say more
}
