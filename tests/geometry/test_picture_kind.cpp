// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_read.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::Folder;

TEST_CASE("an image of a kind that is not drawn is told where its mesh is read") {
    const Folder folder;
    const auto findings = [&](const std::string& image, const std::string& bytes) {
        folder.write(image, bytes);
        folder.write("m.mtl", "newmtl skin\nmap_Kd " + image + "\n");
        std::vector<std::string> finding;
        read_mesh(folder.write("m.obj",
                               "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n"
                               "usemtl skin\nf 1/1 2/1 3/1\nf 1/1 3/1 2/1\n"),
                  {}, &finding);
        return finding;
    };
    CHECK(findings("a.webp", "RIFF0000WEBPVP8 ") ==
          std::vector<std::string>{"material 'skin': its image 'a.webp' is of type WebP; only PNG, "
                                   "JPEG, BMP and TGA are drawn"});
    CHECK(findings("a.tif", std::string("II*\0aaaa", 8)).size() == 1);
    CHECK(findings("a.png", "\x89PNG\r\n\x1a\n").empty());
    CHECK(findings("a.tga", "no mark").empty());
    CHECK(findings("a.png", "").empty());
}
