// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of a file arrive as the light they stand for, images where they belong.
#include <cstring>
#include <set>

#include "base/srgb.h"
#include "geometry/mesh_read.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"
#include "tests/geometry/zip_fixture.h"

using namespace swage;
using test::Folder;
using test::raw;
using test::read_quietly;

namespace {

std::string cube_3mf(const std::string& color) {
    std::string vertices, triangles;
    const TriMesh cube = test::box_mesh({0, 0, 0}, {10, 10, 10});
    for (const Vec3& p : cube.position)
        vertices += fmt::format(R"(<vertex x="{}" y="{}" z="{}"/>)", p.x(), p.y(), p.z());
    for (const Corners& t : cube.triangle)
        triangles +=
            fmt::format(R"(<triangle v1="{}" v2="{}" v3="{}" pid="5" p1="0"/>)", t[0], t[1], t[2]);
    const std::string relations = "http://schemas.openxmlformats.org/package/2006/relationships";
    return test::zip_of(
        {{"[Content_Types].xml",
          R"(<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>)"},
         {"_rels/.rels",
          R"(<?xml version="1.0"?><Relationships xmlns=")" + relations +
              R"("><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)"},
         {"3D/3dmodel.model",
          R"(<?xml version="1.0"?><model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources><basematerials id="5"><base name="paint" displaycolor=")" +
              color +
              R"("/></basematerials><object id="1" type="model" pid="5" pindex="0"><mesh><vertices>)" +
              vertices + "</vertices><triangles>" + triangles +
              R"(</triangles></mesh></object></resources><build><item objectid="1"/></build></model>)"}});
}

// A tetrahedron with one material; `diffuse` is what stands in its <diffuse>.
std::string tetrahedron_dae(const std::string& diffuse) {
    return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_images><image id="i"><init_from>wood.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON>
<newparam sid="s"><surface type="2D"><init_from>i</init_from></surface></newparam>
<newparam sid="t"><sampler2D><source>s</source></sampler2D></newparam>
<technique sid="c"><lambert><diffuse>)" +
           diffuse + R"(</diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="paint"><instance_effect url="#e"/></material>
</library_materials><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="u"><float_array id="ua" count="2">0.5 0.5</float_array>
<technique_common><accessor source="#ua" count="1" stride="2"><param name="S" type="float"/>
<param name="T" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="4" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#u" offset="1" set="0"/><vcount>3 3 3 3</vcount>
<p>0 0 2 0 1 0 0 0 1 0 3 0 0 0 3 0 2 0 1 0 2 0 3 0</p></polylist></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n">
<instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="m" target="#m"/></technique_common></bind_material></instance_geometry>
</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

}  // namespace

TEST_CASE("colours that a file gives as screens show them arrive as light") {
    const Folder folder;
    const auto color = [](const TriMesh& mesh) {
        REQUIRE(mesh.material.size() == 1);
        return mesh.material[0].color;
    };
    const Vec3 grey = Vec3::Constant(linear_from_srgb(128 / 255.0));
    REQUIRE(grey.x() == Approx(0.2159).epsilon(1e-3));
    CHECK((color(read_quietly(folder.write("a.3mf", cube_3mf("#808080FF")))) - grey).norm() < 1e-6);
    const Vec3 mixed(linear_from_srgb(0.5), linear_from_srgb(0.25), 1);
    const TriMesh painted =
        read_quietly(folder.write("a.dae", tetrahedron_dae("<color>0.5 0.25 1 1</color>")));
    CHECK((color(painted) - mixed).norm() < 1e-6);

    // A binary STL file's facets hold 5 bits a colour: blue, green, red, and that it is there.
    const TriMesh cube = test::box_mesh({0, 0, 0}, {1, 1, 1});
    std::string bytes(80, ' ');
    bytes += raw<std::uint32_t>(12);
    for (const Corners& t : cube.triangle) {
        bytes += std::string(12, '\0');
        for (const int i : t) bytes += raw<Eigen::Vector3f>(cube.position[i].cast<float>());
        bytes += raw<std::uint16_t>(0x8000 | (31 << 10) | (16 << 5));
    }
    const TriMesh facets = read_quietly(folder.write("a.stl", bytes));
    REQUIRE(facets.position_color.size() == 8);
    for (const Eigen::Vector3f& c : facets.position_color)
        CHECK((c - Eigen::Vector3f(1, static_cast<float>(linear_from_srgb(16 / 31.0)), 0)).norm() <
              1e-6f);
}

TEST_CASE("an image in a DAE is not darkened by a colour that stands nowhere") {
    const Folder folder;
    folder.write("wood.png", "png");
    const TriMesh mesh = read_quietly(
        folder.write("a.dae", tetrahedron_dae(R"(<texture texture="t" texcoord="UV"/>)")));
    REQUIRE(mesh.material.size() == 1);
    CHECK(mesh.material[0].texture.filename() == "wood.png");
    CHECK(mesh.material[0].color == Vec3::Ones());
}

TEST_CASE("a PLY's colours are bytes whatever whole numbers hold them") {
    const Folder folder;
    const auto red_of = [&](const std::string& type, const std::string& value) {
        std::string text = "ply\nformat ascii 1.0\nelement vertex 3\n";
        for (const char* name : {"x", "y", "z"}) text += fmt::format("property float {}\n", name);
        for (const char* name : {"red", "green", "blue"})
            text += fmt::format("property {} {}\n", type, name);
        text += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
        for (const char* place : {"0 0 0", "1 0 0", "0 1 0"})
            text += fmt::format("{} {} 0 0\n", place, value);
        const TriMesh mesh = read_quietly(folder.write("a.ply", text + "3 0 1 2\n"));
        REQUIRE(mesh.position_color.size() == 3);
        return mesh.position_color[0].x();
    };
    const double light = linear_from_srgb(200 / 255.0);
    for (const char* type : {"uchar", "short", "int", "uint"}) {
        CAPTURE(type);
        CHECK(red_of(type, "200") == Approx(light));
    }
    CHECK(red_of("int", "-3") == 0);
    CHECK(red_of("ushort", "51400") == Approx(light));
    CHECK(red_of("ushort", "655350") == 1);
    CHECK(red_of("float", "0.25") == 0.25f);
}

TEST_CASE("colours of an OBJ or of a PLY's fractions that are counted to 255 are as screens do") {
    const Folder folder;
    const double most = GENERATE(1.0, 255.0);
    CAPTURE(most);
    const std::string color = fmt::format("{} {} 0", most, 0.5 * most);
    const TriMesh obj = read_quietly(
        folder.write("a.obj", "v 0 0 0 " + color + "\nv 1 0 0 " + color + "\nv 0 1 0\nv 0 0 1\n" +
                                  "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"));
    const auto is = [](const Eigen::Vector3f& found, const Vec3& wanted) {
        return (found.cast<double>() - wanted).norm() < 1e-5;
    };
    const Vec3 screen(1, linear_from_srgb(0.5), 0);
    REQUIRE(obj.position_color.size() == 4);
    for (int v = 0; v < 4; ++v) {
        const bool is_given = obj.position[v].y() == 0 && obj.position[v].z() == 0;
        CHECK(is(obj.position_color[v], is_given ? screen : Vec3::Ones()));
    }
    const std::string type = GENERATE("float", "double");
    std::string ply = "ply\nformat ascii 1.0\nelement vertex 3\n";
    for (const char* name : {"x", "y", "z"}) ply += fmt::format("property float {}\n", name);
    for (const char* name : {"red", "green", "blue"}) {
        ply += fmt::format("property {} {}\n", type, name);
    }
    ply += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (const char* place : {"0 0 0 ", "1 0 0 ", "0 1 0 "}) ply += place + color + "\n";
    const TriMesh read = read_quietly(folder.write("a.ply", ply + "3 0 1 2\n"));
    REQUIRE(read.position_color.size() == 3);
    // Fractions of a PLY are light itself.
    CHECK(is(read.position_color[0], most == 1 ? Vec3(1, 0.5, 0) : screen));
}

TEST_CASE("an image lies where an OBJ file's material scales and shifts it to") {
    const Folder folder;
    folder.write("a.png", "png");
    folder.write("a.mtl",
                 "newmtl plain\nmap_Kd a.png\nnewmtl moved\nmap_Kd -s 2 3 1 -o 0.5 0.25 a.png\n"
                 "d 0.5\n");
    std::string text = test::cube_obj();
    text.insert(text.find("f 1"), "mtllib a.mtl\nusemtl plain\n");
    text.insert(text.find("f 4/1"), "usemtl moved\n");
    std::vector<std::string> finding;
    const TriMesh cube = read_mesh(folder.write("a.obj", text), {}, &finding);
    REQUIRE(cube.triangle.size() == 12);
    CHECK(cube.material[1].texture.filename() == "a.png");
    std::set<std::pair<double, double>> plain, moved;
    for (std::size_t t = 0; t < 12; ++t)
        for (const int i : cube.triangle_uv[t])
            (t < 10 ? plain : moved).emplace(cube.uv[i].x(), cube.uv[i].y());
    CHECK(plain == std::set<std::pair<double, double>>{{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    CHECK(moved ==
          std::set<std::pair<double, double>>{{0.5, 0.25}, {2.5, 0.25}, {2.5, 3.25}, {0.5, 3.25}});
    REQUIRE(finding.size() == 1);
    CHECK(finding[0] == "the material 'moved' transmits light (d, Tr): drawn opaque");
}

TEST_CASE("what of an OBJ's materials is not drawn is told, where it would show") {
    const Folder folder;
    folder.write("a.png", "png");
    const auto findings = [&](const std::string& of) {
        folder.write("a.mtl", "newmtl one\nKd 1 0 0\n" + of + "newmtl idle\nKs 1 1 1\n");
        std::string text = test::cube_obj();
        text.insert(text.find("f 1"), "mtllib a.mtl\nusemtl one\n");
        text.replace(text.find("vt 1 1"), 6, "vt 2 1");
        std::vector<std::string> finding;
        read_mesh(folder.write("a.obj", text), {}, &finding);
        return finding;
    };
    CHECK(
        findings("Ks 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nillum 2\nmap_Kd -clamp off a.png\n").empty());
    CHECK(findings("Ks 0 0 0.5\nKe 2\nKa 1 1 1\nmap_Kd -clamp on a.png\n") ==
          std::vector<std::string>{
              "of the materials' values only Kd, Ns, Pr and Pm are used, not Ke, Ks",
              "the material 'one' does not repeat its image beyond the borders (-clamp on): drawn "
              "repeated"});
    CHECK(findings("Tr 0\nd 1\n").empty());  // both opaque
    CHECK(findings("Tr 0.2\n").size() == 1);
    CHECK(findings("d 0.2\n") == findings("Tr 0.2\n"));
}

TEST_CASE("colours that jump at an edge stay with their faces") {
    const Folder folder;
    const TriMesh cube = test::box_mesh({0, 0, 0}, {1, 1, 1});
    // What a triangle is called by its material's colour, rounded.
    const auto check = [&](const TriMesh& mesh, const std::vector<std::string>& finding) {
        CHECK(finding.empty());
        REQUIRE(mesh.position.size() == 8);
        REQUIRE(mesh.triangle.size() == 12);
        REQUIRE(mesh.position_color.empty());
        REQUIRE(mesh.material.size() == 6);
        for (std::size_t t = 0; t < 12; ++t) {
            const int face = static_cast<int>(t) / 2;
            const Vec3 expected(face & 1, (face >> 1) & 1, (face >> 2) & 1);
            CHECK((mesh.material[mesh.triangle_material[t]].color - expected).norm() < 1e-6);
        }
        CHECK(mesh.material[3].name == "paint_ffff00");
    };
    std::vector<std::string> finding;
    std::string stl(80, ' ');
    stl += raw<std::uint32_t>(12);
    std::string off = "OFF\n8 12 0\n", ply = "ply\nformat ascii 1.0\nelement vertex 36\n";
    for (const char* name :
         {"float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"})
        ply += fmt::format("property {}\n", name);
    ply += "element face 12\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3& p : cube.position) off += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    std::string faces;
    for (int t = 0; t < 12; ++t) {
        const int face = t / 2, red = face & 1, green = (face >> 1) & 1, blue = face >> 2;
        stl += std::string(12, '\0');
        for (const int i : cube.triangle[t]) {
            const Vec3& p = cube.position[i];
            stl += raw<Eigen::Vector3f>(p.cast<float>());
            ply += fmt::format("{} {} {} {} {} {}\n", p.x(), p.y(), p.z(), 255 * red, 255 * green,
                               255 * blue);
        }
        stl += raw<std::uint16_t>(
            static_cast<std::uint16_t>(0x8000 | (31 * red << 10) | (31 * green << 5) | 31 * blue));
        const Corners& c = cube.triangle[t];
        off += fmt::format("3 {} {} {} {} {} {} 255\n", c[0], c[1], c[2], 255 * red, 255 * green,
                           255 * blue);
        faces += fmt::format("3 {} {} {}\n", 3 * t, 3 * t + 1, 3 * t + 2);
    }
    check(read_mesh(folder.write("a.stl", stl), {}, &finding), finding);
    check(read_mesh(folder.write("a.off", off), {}, &finding), finding);
    check(read_mesh(folder.write("a.ply", ply + faces), {}, &finding), finding);

    // Where a face's own corners differ as well, one colour a place is all that can be kept.
    const std::size_t at = ply.find("255 0 0\n");
    REQUIRE(at != std::string::npos);
    ply.replace(at, 7, "250 0 0");
    const TriMesh smeared = read_mesh(folder.write("b.ply", ply + faces), {}, &finding);
    CHECK(smeared.position_color.size() == 8);
    REQUIRE(finding.size() == 1);
    CHECK(finding[0] ==
          "at 8 of 8 vertices the colours of adjacent faces differ: one of them was taken");
}

TEST_CASE("materials keep their names where they have no colours, or one alone") {
    const Folder folder;
    // Three triangles side by side in a row, each with places of its own, two of them coloured.
    std::string text;
    const auto triangle = [&](int x, const char* color) {
        for (const auto& [dx, y] : {std::pair(0, 0), {1, 0}, {x % 2, 1}})
            text += fmt::format("v {} {} 0{}\n", x + dx, y, color);
    };
    triangle(0, "");
    triangle(1, " 1 0 0");
    triangle(2, " 0 1 0");
    const auto names = [&](const std::string& faces) {
        std::vector<std::string> finding, name;
        const TriMesh mesh = read_mesh(folder.write("a.obj", text + faces), {}, &finding);
        CHECK(mesh.position_color.empty());
        for (const SurfaceMaterial& m : mesh.material) name.push_back(m.name);
        return name;
    };
    using Names = std::vector<std::string>;
    // Colours are of what the material has.
    folder.write("half.mtl", "newmtl motley\nKd 0.5 0.25 1\n");
    const TriMesh half = read_quietly(
        folder.write("half.obj", "mtllib half.mtl\n" + text + "usemtl motley\nf 4 5 6\nf 7 8 9\n"));
    REQUIRE(half.material.size() == 2);
    CHECK((half.material[0].color - Vec3(0.5, 0, 0)).norm() < 1e-6);
    CHECK((half.material[1].color - Vec3(0, 0.25, 0)).norm() < 1e-6);
    CHECK(names("usemtl side checks\nf 1 2 3\nusemtl red\nf 4 5 6\nusemtl green\nf 7 8 9\n") ==
          Names{"side checks", "red", "green"});
    CHECK(names("usemtl side checks\nf 1 2 3\nusemtl motley\nf 4 5 6\nf 7 8 9\n") ==
          Names{"side checks", "motley_ff0000", "motley_00ff00"});
    CHECK(names("usemtl one\nf 1 2 3\nf 4 5 6\nf 7 8 9\n") ==
          Names{"one", "one_ff0000", "one_00ff00"});
}

TEST_CASE("an OFF's values stand in the order that Geomview gives them") {
    const Folder folder;
    const std::string rest = "3 0 1 2\n";
    std::vector<std::string> finding;
    const auto read = [&](const std::string& text) {
        finding.clear();
        return read_mesh(folder.write("a.off", text), {}, &finding);
    };
    // Place, normal, colour, texture coordinates.
    const TriMesh all = read(
        "STCNOFF 3 1 0\n0 0 0 0 0 1 255 0 0 255 .5 .25\n1 0 0 0 0 1 0 255 0 255 0 0\n"
        "0 1 0 0 0 1 0 0 51 255 1 1\n" +
        rest);
    REQUIRE(all.position_color.size() == 3);
    CHECK(all.position_color[0] == Eigen::Vector3f(1, 0, 0));
    CHECK(all.position_color[2].z() == Approx(linear_from_srgb(0.2)));
    REQUIRE(all.uv.size() == 3);
    CHECK(all.uv[all.triangle_uv[0][0]] == Vec2(0.5, 0.25));
    CHECK(finding.empty());
    const TriMesh three = read("COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 0 .5 0\n0 1 0 0 0 1\n" + rest);
    CHECK(three.position_color[0] == Eigen::Vector3f(1, 0, 0));
    CHECK(three.position_color[1].y() == Approx(linear_from_srgb(0.5)));
    const TriMesh weighted = read("4OFF\n3 1 0\n0 0 0 1\n2 0 0 2\n0 3 0 1.5 # a note\n" + rest);
    CHECK(weighted.position[1] == Vec3(1, 0, 0));
    CHECK(weighted.position[2] == Vec3(0, 2, 0));
    // What is left out is told.
    read("OFF\n3 1 0\n0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2 7\n");
    CHECK(finding ==
          std::vector<std::string>{"further values of its vertices were left out",
                                   "colours given as indices into a colour map were left out"});
    CHECK_THROWS_WITH(read("nOFF\n4\n3 1 0\n"), Catch::Contains("nOFF"));
    CHECK_THROWS_WITH(read("OFF BINARY\n"), Catch::Contains("binary OFF cannot be read"));
    CHECK_THROWS_WITH(read("NOFF\n3 1 0\n0 0 0 1\n"), Catch::Contains("vertex 0 has 4 values"));
}

TEST_CASE("a surface without colours leaves no white on the seam with one that has them") {
    const Folder folder;
    const std::string plain = "v 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\n",
                      colored = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 0\n";
    for (const bool first : {false, true}) {
        std::vector<std::string> finding;
        const TriMesh mesh = read_mesh(
            folder.write("a.obj", (first ? colored : plain) + "usemtl " + (first ? "c" : "p") +
                                      "\nf 1 2 3 4\n" + (first ? plain : colored) + "usemtl " +
                                      (first ? "p" : "c") + "\nf 5 6 7 8\n"),
            {}, &finding);
        REQUIRE(mesh.position.size() == 6);
        REQUIRE(mesh.position_color.size() == 6);
        for (std::size_t i = 0; i < 6; ++i) {
            const Vec3& p = mesh.position[i];
            if (p.x() == 1) CHECK(mesh.position_color[i].x() == 0);
            if (p.x() == 2) CHECK(mesh.position_color[i] == Eigen::Vector3f::Ones());
        }
        REQUIRE(mesh.material.size() == 2);
        for (const SurfaceMaterial& m : mesh.material) CHECK(m.takes_colors == (m.name == "c"));
    }
}
