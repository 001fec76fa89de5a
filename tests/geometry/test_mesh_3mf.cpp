// SPDX-License-Identifier: GPL-3.0-or-later
// A 3MF file's units, and parts of its model in files of their own.
#include "base/error.h"
#include "geometry/mesh_read.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"
#include "tests/geometry/zip_fixture.h"
#include "tests/shared/says.h"

using namespace swage;
using test::Folder;

namespace {

const std::string kCore = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
const std::string kProduction = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";

// An object that is a box from 0 to `size`.
std::string box_object(int id, const Vec3& size, const std::string& paint = "") {
    std::string vertices, triangles;
    const TriMesh box = test::box_mesh({0, 0, 0}, size);
    for (const Vec3& p : box.position)
        vertices += fmt::format(R"(<vertex x="{}" y="{}" z="{}"/>)", p.x(), p.y(), p.z());
    for (const Corners& t : box.triangle)
        triangles +=
            fmt::format(R"(<triangle v1="{}" v2="{}" v3="{}"{}/>)", t[0], t[1], t[2], paint);
    return fmt::format(R"(<object id="{}" type="model"><mesh><vertices>{}</vertices><triangles>{}
</triangles></mesh></object>)",
                       id, vertices, triangles);
}

std::string model(const std::string& attributes, const std::string& resources,
                  const std::string& items) {
    return R"(<?xml version="1.0"?><!-- <model unit="foot"> --><model )" + attributes +
           R"( xmlns=")" + kCore + R"(" xmlns:p=")" + kProduction + R"("><resources>)" + resources +
           "</resources><build>" + items + "</build></model>";
}

std::vector<std::pair<std::string, std::string>> files_of(const std::string& root) {
    return {
        {"[Content_Types].xml",
         R"(<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>)"},
        {"_rels/.rels",
         R"(<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)"},
        {"3D/3dmodel.model", root}};
}

const std::string kOneItem = R"(<item objectid="1"/>)";

}  // namespace

TEST_CASE("a 3MF is scaled by the unit it states, millimetres where it states none") {
    const Folder folder;
    for (const auto& [unit, metres] :
         {std::pair(R"(unit="inch")", 0.0254), std::pair(R"(unit = 'micron')", 1e-6),
          std::pair(R"(unit="meter")", 1.0), std::pair("", 1e-3)}) {
        CAPTURE(unit);
        std::vector<std::string> finding;
        const TriMesh mesh = read_mesh(
            folder.write("a.3mf",
                         test::zip_of(files_of(model(unit, box_object(1, {1, 2, 3}), kOneItem)))),
            {}, &finding);
        CHECK((box_of(mesh.position).size() - metres * Vec3(1, 2, 3)).norm() < 1e-9 * metres);
        CHECK(finding.empty());
    }
    CHECK_THROWS_WITH(
        test::read_quietly(folder.write(
            "a.3mf",
            test::zip_of(files_of(model(R"(unit="ell")", box_object(1, {1, 1, 1}), kOneItem))))),
        Catch::Contains("'ell' is not a unit of 3MF"));
}

TEST_CASE("a 3MF is read whatever sizes its archive has room for") {
    const Folder folder;
    const auto files = files_of(model("", box_object(1, {1, 2, 3}), kOneItem));
    const TriMesh plain = test::read_quietly(folder.write("a.3mf", test::zip_of(files)));
    const TriMesh wide = test::read_quietly(folder.write("b.3mf", test::zip64_of(files)));
    CHECK(wide.position == plain.position);
    CHECK(wide.triangle == plain.triangle);
}

TEST_CASE("parts of a 3MF's model that stand in other files are read from there") {
    const Folder folder;
    // Both files call an object 1; the build names one of them by its file.
    const std::string red =
        R"(<basematerials id="2"><base name="red" displaycolor="#FF0000"/></basematerials>)";
    const std::string root = model(
        R"(requiredextensions="p" unit="centimeter")",
        box_object(1, {1, 1, 1}) +
            R"(<object id="5" type="model"><components><component p:path="/3D/Objects/a.model" objectid="1" transform="1 0 0 0 1 0 0 0 1 10 0 0"/></components></object>)",
        kOneItem +
            R"(<item objectid="5" transform="1 0 0 0 1 0 0 0 1 0 20 0"/><item p:path="/3D/Objects/b.model" objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 -9"/>)");
    auto files = files_of(root);
    files.emplace_back(
        "3D/Objects/a.model",
        model(R"(unit="centimeter")", red + box_object(1, {2, 2, 2}, R"( pid="2" p1="0")"), ""));
    files.emplace_back("3D/Objects/b.model",
                       model(R"(unit="centimeter")", box_object(1, {3, 3, 3}), ""));
    for (const bool packed : {false, true}) {
        CAPTURE(packed);
        const TriMesh mesh = test::read_quietly(folder.write("a.3mf", test::zip_of(files, packed)));
        CHECK(mesh.triangle.size() == 36);
        CHECK(signed_volume(mesh) == Approx(36e-6).epsilon(1e-6));
        const Box box = box_of(mesh.position);
        CHECK((box.low - 0.01 * Vec3(0, 0, -9)).norm() < 1e-8);
        CHECK((box.high - 0.01 * Vec3(12, 22, 2)).norm() < 1e-8);
        CHECK(std::any_of(mesh.material.begin(), mesh.material.end(),
                          [](const SurfaceMaterial& m) { return m.color == Vec3(1, 0, 0); }));
    }
    std::string damaged = test::zip_of(files);
    damaged[damaged.find("displaycolor") + 15] = '0';
    CHECK_THROWS_WITH(test::read_quietly(folder.write("b.3mf", damaged)),
                      Catch::Contains("its part '3D/Objects/a.model' is damaged"));
    files.pop_back();
    CHECK_THROWS_WITH(test::read_quietly(folder.write("b.3mf", test::zip_of(files))),
                      Catch::Contains("its part '3D/Objects/b.model' is missing"));
    files.emplace_back("3D/Objects/b.model", model("", box_object(1, {3, 3, 3}), ""));
    CHECK_THROWS_WITH(test::read_quietly(folder.write("b.3mf", test::zip_of(files))),
                      Catch::Contains("'3D/Objects/b.model' has a different unit"));
}

TEST_CASE("a 3MF that asks for an extension which nobody follows is refused by its name") {
    const Folder folder;
    const std::string beams =
        R"(xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02" )";
    const auto written = [&](const std::string& attributes) {
        return folder.write(
            "a.3mf", test::zip_of(files_of(model(attributes, box_object(1, {1, 1, 1}), kOneItem))));
    };
    CHECK_THROWS_WITH(
        test::read_quietly(written(beams + R"(requiredextensions="p b")")),
        Catch::Contains("requires the extension http://schemas.microsoft.com/"
                        "3dmanufacturing/beamlattice/2017/02, which is not supported"));
    CHECK_NOTHROW(test::read_quietly(written(beams)));
}

TEST_CASE("a damaged 3MF is refused by the part that is damaged") {
    const Folder folder;
    const std::string good = model("", box_object(1, {1, 1, 1}), kOneItem);
    const auto refusal = [&](const std::string& bytes, const ReadLimits& limits = {}) {
        try {
            std::vector<std::string> finding;
            read_mesh(folder.write("a.3mf", bytes), limits, &finding);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const auto says = [](const char* text) { return Catch::Contains(text); };
    for (const std::string& text :
         {std::string(), std::string("no model"), good.substr(0, good.size() / 2),
          std::string(good).replace(good.find("</vertices>"), 11, "</triangles>"),
          std::string(good).insert(good.find("<resources>"), std::string(100000, '<'))}) {
        CAPTURE(text.substr(0, 300));
        CHECK_THAT(refusal(test::zip_of(files_of(text))),
                   says("its part '3D/3dmodel.model' is damaged near byte"));
    }
    // However deep: what is not known is passed over.
    std::string deep;
    for (int k = 0; k < 100000; ++k) deep += "<a>";
    for (int k = 0; k < 100000; ++k) deep += "</a>";
    CHECK(refusal(test::zip_of(files_of(std::string(good).insert(good.find("<build>"), deep))))
              .empty());

    // A size that is not so, in the directory; larger than a file may be; packed in ways unknown.
    for (const bool packed : {false, true}) {
        CAPTURE(packed);
        const std::string zip = test::zip_of(files_of(good), packed);
        const std::size_t entry = zip.rfind("3D/3dmodel.model") - 46;
        for (const std::size_t size : {std::size_t{0}, good.size() - 1, good.size() + 1}) {
            std::string lies = zip;
            lies.replace(entry + 24, 4, test::raw(static_cast<std::uint32_t>(size)));
            CHECK_THAT(refusal(lies), says("its part '3D/3dmodel.model' is damaged"));
        }
        ReadLimits limits;
        limits.file_bytes = zip.size() + 100;
        CHECK(refusal(zip, limits).empty());
        std::string bomb = zip;
        bomb.replace(entry + 24, 4, test::raw(static_cast<std::uint32_t>(limits.file_bytes + 1)));
        CHECK_THAT(refusal(bomb, limits),
                   says("its part '3D/3dmodel.model' is larger than a file may be"));
        std::string unknown = zip;
        unknown[entry + 10] = 12;
        CHECK_THAT(refusal(unknown), says("uses a compression that cannot be read (12)"));
        for (std::size_t cut = 1; cut < zip.size(); cut += 97)
            CHECK_THAT(refusal(zip.substr(0, cut)), says("it is not a ZIP file, or is damaged"));
    }
}

TEST_CASE("what a 3MF's model says is taken as XML means it") {
    const Folder folder;
    auto files = files_of(model(
        R"(unit="centi&#109;eter")",
        R"(<metadata name="note">a &lt; b<![CDATA[<resources>&]]></metadata><object id="5"><components><component p:path="/3D/a&amp;b.model" objectid="1"/></components></object>)",
        R"(<item objectid="5"/>)"));
    files.emplace_back("3D/a&b.model", model(R"(unit="centimeter")", box_object(1, {1, 2, 3}), ""));
    const TriMesh mesh = test::read_quietly(folder.write("a.3mf", test::zip_of(files)));
    CHECK((box_of(mesh.position).size() - Vec3(0.01, 0.02, 0.03)).norm() < 1e-9);
}

TEST_CASE("objects of a 3MF that are made of another twice, 28 deep, are refused at once") {
    const Folder folder;
    const auto read = [&](int levels) {
        std::string objects = box_object(1, {1, 1, 1});
        for (int n = 2; n <= levels; ++n)
            objects += fmt::format(
                R"(<object id="{}" type="model"><components><component objectid="{}"/>
<component objectid="{}" transform="1 0 0 0 1 0 0 0 1 {} 0 0"/></components></object>)",
                n, n - 1, n - 1, 2 << n);
        const std::string item = fmt::format(R"(<item objectid="{}"/>)", levels);
        return test::read_quietly(
            folder.write("a.3mf", test::zip_of(files_of(model("", objects, item)))));
    };
    CHECK(read(4).triangle.size() == 8 * 12);
    CHECK_THROWS_WITH(read(28), Catch::Contains("reading it takes more than the 8 GiB allowed"));
}

namespace {

const std::string kMaterial = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";

// Red and green, as a colour group or as base materials.
std::string red_and_green(bool as_group) {
    return as_group
               ? R"(<m:colorgroup id="7"><m:color color="#FF0000"/><m:color color="#00FF00"/></m:colorgroup>)"
               : R"(<basematerials id="7"><base name="red" displaycolor="#FF0000"/><base name="green" displaycolor="#00FF00"/></basematerials>)";
}

struct Painted {
    TriMesh mesh;
    std::string told;

    // Of all its triangles; -1: of no one colour.
    Vec3 color() const {
        Vec3 all = Vec3::Constant(-1);
        for (std::size_t t = 0; t < mesh.triangle_material.size(); ++t) {
            const Vec3& own = mesh.material[std::size_t(mesh.triangle_material[t])].color;
            if (t > 0 && own != all) return Vec3::Constant(-1);
            all = own;
        }
        return all;
    }
};

Painted painted(const std::string& resources, const std::string& items = kOneItem) {
    const Folder folder;
    std::vector<std::string> finding;
    Painted read;
    read.mesh =
        read_mesh(folder.write("a.3mf", test::zip_of(files_of(model("xmlns:m=\"" + kMaterial + "\"",
                                                                    resources, items)))),
                  {}, &finding);
    for (const std::string& one : finding) read.told += one + "\n";
    return read;
}

std::string object_of(const std::string& box, const std::string& attributes) {
    return test::replaced(box, "type=\"model\"", "type=\"model\" " + attributes);
}

}  // namespace

TEST_CASE("a 3MF's object has the colour that it names, of a group of colours too") {
    const bool as_group = GENERATE(false, true), by_triangles = GENERATE(false, true);
    CAPTURE(as_group, by_triangles);
    const Painted read =
        painted(red_and_green(as_group) +
                (by_triangles ? box_object(1, {1, 1, 1}, R"( pid="7" p1="1")")
                              : object_of(box_object(1, {1, 1, 1}), R"(pid="7" pindex="1")")));
    CHECK(read.color() == Vec3(0, 1, 0));
    CHECK(read.told.empty());
}

TEST_CASE("of a 3MF's object of several colours all is what most of it is, and that is told") {
    const bool as_group = GENERATE(false, true);
    CAPTURE(as_group);
    std::string box = object_of(box_object(1, {1, 1, 1}), R"(pid="7" pindex="1")");
    // The last of them, by which assimp goes, and one whose colours change across it.
    box.insert(box.rfind("/>"), R"( pid="7" p1="0")");
    box = test::replaced(box, R"(v3="1")", R"(v3="1" p1="1" p2="0" p3="1")");
    const Painted read = painted(red_and_green(as_group) + box);
    CHECK(read.color() == Vec3(0, 1, 0));
    CHECK(test::says(read.told,
                     "2 triangles have another colour than most of their object, which "
                     "all of it was given"));
}

TEST_CASE("images in a 3MF's own lists are left out, told, and leave grey") {
    const Painted read = painted(
        R"(<m:texture2d id="3" path="/3D/t.png" contenttype="image/png"/><m:texture2dgroup id="7" texid="3"><m:tex2coord u="0" v="0"/><m:tex2coord u="1" v="0"/><m:tex2coord u="0" v="1"/></m:texture2dgroup>)" +
        object_of(box_object(1, {1, 1, 1}, R"( pid="7" p1="0" p2="1" p3="2")"),
                  R"(pid="7" pindex="0")"));
    CHECK(test::says(read.told, "its images (texture2dgroup) were left out"));
    CHECK_FALSE(test::says(read.told, "missing"));
    CHECK(read.mesh.material.empty());  // and so is drawn in a grey
    const Painted mixed = painted(
        R"(<m:multiproperties id="9" pids="7"><m:multi pindices="0"/></m:multiproperties>)" +
        box_object(1, {1, 1, 1}, R"( pid="9" p1="0")"));
    CHECK(test::says(mixed.told, "materials of several parts (multiproperties) were left out"));
}

TEST_CASE("a 3MF's object that is no model is read as matter, which is told") {
    const auto read = [](const std::string& type, const std::string& items) {
        return painted(box_object(1, {1, 1, 1}) + test::replaced(box_object(2, {1, 1, 1}),
                                                                 "\"model\"", "\"" + type + "\""),
                       items);
    };
    const std::string both =
        kOneItem + R"(<item objectid="2" transform="1 0 0 0 1 0 0 0 1 5 0 0"/>)";
    CHECK(test::says(read("support", both).told,
                     "object 2 is of type 'support' and becomes matter all the same"));
    CHECK(read("model", both).told.empty());
    CHECK(read("support", kOneItem).told.empty());  // not built, and so not read
}
