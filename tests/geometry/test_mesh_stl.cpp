// SPDX-License-Identifier: GPL-3.0-or-later
#include <cctype>

#include "base/error.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::Folder;
using test::raw;
using test::read_quietly;
using test::replaced;

namespace {

// A unit cube as split triangles, for formats without shared vertices.
std::string cube_stl_ascii() {
    const TriMesh cube = test::box_mesh({0, 0, 0}, {1, 1, 1});
    std::string text = "solid cube\n";
    for (const Corners& t : cube.triangle) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const int i : t)
            text += fmt::format("vertex {} {} {}\n", cube.position[i].x(), cube.position[i].y(),
                                cube.position[i].z());
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid cube\n";
}

std::string cube_stl_binary() {
    const TriMesh cube = test::box_mesh({0, 0, 0}, {1, 1, 1});
    std::string bytes(80, ' ');
    bytes += raw<std::uint32_t>(12);
    for (const Corners& t : cube.triangle) {
        for (int k = 0; k < 3; ++k) bytes += raw<float>(0);
        for (const int i : t)
            for (int k = 0; k < 3; ++k)
                bytes += raw<float>(static_cast<float>(cube.position[i][k]));
        bytes += raw<std::uint16_t>(0);
    }
    return bytes;
}

std::string refusal(const std::filesystem::path& file) {
    try {
        read_quietly(file);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("STL, text or binary, is welded into a closed cube") {
    const Folder folder;
    for (const auto& [name, bytes] :
         {std::pair("a.stl", cube_stl_ascii()), std::pair("b.stl", cube_stl_binary())}) {
        CAPTURE(name);
        const TriMesh cube = read_quietly(folder.write(name, bytes));
        CHECK(cube.position.size() == 8);
        CHECK(cube.triangle.size() == 12);
        CHECK(cube.material.empty());
        CHECK(check_mesh(cube).bounds_a_volume());
        CHECK(signed_volume(cube) == Approx(1));
    }
}

TEST_CASE("an STL's words may be in capitals, a binary one may begin like text and end in more") {
    const Folder folder;
    std::string capitals = cube_stl_ascii();
    for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    std::string binary = cube_stl_binary();
    binary.replace(0, 10, "solid cube");
    std::vector<std::string> finding;
    for (const std::string& bytes :
         {capitals, binary, binary + "extra!!", cube_stl_binary() + "x"}) {
        const TriMesh cube = read_mesh(folder.write("a.stl", bytes), {}, &finding);
        CHECK(cube.triangle.size() == 12);
        CHECK(signed_volume(cube) == Approx(1));
    }
    CHECK(finding == std::vector<std::string>{"7 bytes after its last facet left out",
                                              "1 byte after its last facet left out"});
    const TriMesh named = read_quietly(
        folder.write("b.stl", replaced(replaced(capitals, "SOLID CUBE", "SOLID My Cube"),
                                       "ENDSOLID CUBE", "EndSolid My Cube")));
    CHECK(named.triangle.size() == 12);
}

TEST_CASE("a text STL may begin with blank lines, and is checked all the same") {
    const Folder folder;
    std::string text = cube_stl_ascii(), capitals = text;
    for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    for (const std::string before : {"\n", " ", "\r\n\t", "\xef\xbb\xbf"}) {
        CAPTURE(before);
        for (const std::string& good :
             {text, capitals, "solid none\nendsolid none\n" + text, text + std::string(9, '\0')})
            CHECK(read_quietly(folder.write("a.stl", before + good)).triangle.size() == 12);
        CHECK(refusal(folder.write("b.stl",
                                   before + replaced(text, "endloop", "vertex 0 0 1\nendloop")))
                  .find("facet 1 has 4 vertices") != std::string::npos);
        CHECK(!refusal(folder.write("c.stl", before + replaced(text, "facet", "fazet"))).empty());
    }
    const std::string name = "solid the facet normal 1 endsolid";
    CHECK(read_quietly(folder.write("d.stl", replaced(text, "solid cube", name))).triangle.size() ==
          12);
    std::string binary = cube_stl_binary();
    binary.replace(0, 12, "\n solid cube");
    CHECK(read_quietly(folder.write("e.stl", binary)).triangle.size() == 12);
    std::string spaced = cube_stl_ascii();
    for (std::size_t at = 0; (at = spaced.find('\n', at)) != std::string::npos; at += 2)
        spaced.replace(at, 1, "\r\n");
    CHECK(read_quietly(folder.write("f.stl", spaced)).triangle.size() == 12);
}

TEST_CASE("an STL file that breaks off anywhere is refused, as text and binary") {
    const Folder folder;
    const std::string text = cube_stl_ascii();
    for (const char* last : {"solid", "facet", "normal", "outer", "loop", "vertex", "endloop",
                             "endfacet", "endsolid"}) {
        CAPTURE(last);
        const std::size_t at = text.rfind(last);
        CHECK(!refusal(folder.write("a.stl", text.substr(0, at))).empty());
        if (last != std::string("endsolid"))
            CHECK(!refusal(folder.write("b.stl", text.substr(0, at + 4))).empty());
    }
    std::string zero = text;
    zero[text.rfind("facet normal") - 1] = '\0';
    CHECK(!refusal(folder.write("c.stl", zero)).empty());
    std::string binary = cube_stl_binary();
    for (const char* head : {"anything", "solid me", " solid x"}) {
        binary.replace(0, 8, head);
        CHECK(refusal(folder.write("d.stl", binary.substr(0, binary.size() - 1)))
                  .find("is cut short") != std::string::npos);
    }
}

TEST_CASE("text that tells places far from its origin is read as finely, or told of") {
    // 2 cm, at 500 km.
    const Folder folder;
    const Vec3 far(5e5, -3e5, 1e5);
    const TriMesh box = test::box_mesh(far, far + Vec3(0.02, 0.02, 0.02));
    std::string text = "solid a\n";
    for (const Corners& t : box.triangle) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const int i : t) {
            const Vec3& p = box.position[i];
            text += fmt::format("vertex {:.3f} {:.3f} {:.3f}\n", p.x(), p.y(), p.z());
        }
        text += "endloop\nendfacet\n";
    }
    std::vector<std::string> finding;
    const auto read = [&](const char* name, const std::string& bytes) {
        finding.clear();
        return read_mesh(folder.write(name, bytes), {}, &finding);
    };
    const TriMesh mesh = read("a.stl", text + "endsolid a\n");
    CHECK((box_of(mesh.position).size() - Vec3(0.02, 0.02, 0.02)).norm() < 1e-9);
    CHECK(mesh.position.size() == 8);
    CHECK(finding.empty());
    // Binary ones have no more than that themselves: 20 cm, at 5 km.
    std::string bytes(80, ' ');
    bytes += raw<std::uint32_t>(12);
    for (const Corners& t : box.triangle) {
        for (int k = 0; k < 3; ++k) bytes += raw<float>(0);
        for (const int i : t) {
            const Vec3 p = 0.01 * far + 10 * (box.position[i] - far);
            for (int k = 0; k < 3; ++k) bytes += raw<float>(static_cast<float>(p[k]));
        }
        bytes += raw<std::uint16_t>(0);
    }
    read("b.stl", bytes);
    REQUIRE(finding.size() == 1);
    CHECK(finding[0].find("its places are rounded by up to 298 um") != std::string::npos);
    CHECK(finding[0].find("move it nearer to its origin") != std::string::npos);
    read("c.stl", cube_stl_binary());
    CHECK(finding.empty());
}
