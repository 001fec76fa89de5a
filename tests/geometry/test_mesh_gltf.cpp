// SPDX-License-Identifier: GPL-3.0-or-later
// What glTF may write down in several ways is read alike.
#include "base/error.h"
#include "geometry/mesh_read.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::Folder;
using test::raw;

namespace {

struct Values {
    std::string name;  // of the attribute
    int type = 5126;   // a float
    int width = 3;
    std::vector<double> value;
    bool normalized = false;

    std::string item(std::size_t i) const {
        const double v = value[i];
        switch (type) {
            case 5120:
                return raw(static_cast<std::int8_t>(v));
            case 5121:
                return raw(static_cast<std::uint8_t>(v));
            case 5122:
                return raw(static_cast<std::int16_t>(v));
            case 5123:
                return raw(static_cast<std::uint16_t>(v));
            default:
                return raw(static_cast<float>(v));
        }
    }
};

struct Document {
    std::string json, bin;
};

// Four vertices, two triangles; each attribute in a view of its own, padded to four bytes.
Document document_of(const std::vector<Values>& attributes, const std::string& uri,
                     const std::string& more = "", const std::string& node = "") {
    std::string bin, views, accessors, names;
    const auto add_view = [&](const std::string& bytes, const std::string& stride) {
        views += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}{}}})",
                             views.empty() ? "" : ",", bin.size(), bytes.size(), stride);
        bin += bytes;
    };
    int id = 0;
    for (const Values& v : attributes) {
        std::string bytes;
        std::size_t stride = 0;
        for (std::size_t i = 0; i < v.value.size(); ++i) {
            bytes += v.item(i);
            if ((i + 1) % static_cast<std::size_t>(v.width) != 0) continue;
            while (bytes.size() % 4 != 0) bytes += '\x7f';
            if (stride == 0) stride = bytes.size();
        }
        add_view(bytes, fmt::format(R"(,"byteStride":{})", stride));
        accessors += fmt::format(
            R"({{"bufferView":{0},"componentType":{1},"count":{2},"type":"VEC{3}","normalized":{4}}},)",
            id, v.type, v.value.size() / static_cast<std::size_t>(v.width), v.width, v.normalized);
        if (!v.name.empty())
            names += fmt::format(R"({}"{}":{})", names.empty() ? "" : ",", v.name, id);
        ++id;
    }
    std::string index;
    for (const std::uint16_t i : {0, 1, 2, 0, 2, 3}) index += raw(i);
    add_view(index, "");
    accessors +=
        fmt::format(R"({{"bufferView":{},"componentType":5123,"count":6,"type":"SCALAR"}})", id);
    return {fmt::format(R"({{"asset":{{"version":"2.0"}},{}"scene":0,"scenes":[{{"nodes":[0]}}],
"nodes":[{{"mesh":0{}}}],"meshes":[{{"primitives":[{{"attributes":{{{}}},"indices":{}}}]}}],
"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}{}}}]}})",
                        more, node, names, id, accessors, views, bin.size(), uri),
            bin};
}

struct Reading {
    TriMesh mesh;
    std::vector<std::string> finding;
};

Reading read(const Folder& folder, const std::vector<Values>& attributes,
             const std::string& more = "", const std::string& node = "") {
    const Document document = document_of(attributes, R"(,"uri":"my%20data.bin")", more, node);
    folder.write("my data.bin", document.bin);
    Reading reading;
    reading.mesh = read_mesh(folder.write("a.gltf", document.json), {}, &reading.finding);
    // In one file it is the same.
    const Document inside = document_of(attributes, "", more, node);
    std::string json = inside.json, bin = inside.bin;
    while (json.size() % 4 != 0) json += ' ';
    while (bin.size() % 4 != 0) bin += '\0';
    const auto size = [](std::size_t bytes) { return raw(static_cast<std::uint32_t>(bytes)); };
    const auto file = folder.write("a.glb", "glTF" + size(2) + size(28 + json.size() + bin.size()) +
                                                size(json.size()) + "JSON" + json +
                                                size(bin.size()) + std::string("BIN\0", 4) + bin);
    const TriMesh packed = test::read_quietly(file);
    CHECK(packed.position == reading.mesh.position);
    CHECK(packed.uv == reading.mesh.uv);
    CHECK(packed.position_color == reading.mesh.position_color);
    return reading;
}

const Values kSquare{"POSITION", 5126, 3, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}};

Values scaled(Values values, int type, double scale, bool normalized) {
    for (double& v : values.value) v *= scale;
    values.type = type;
    values.normalized = normalized;
    return values;
}

struct Kind {
    int type;
    double most;
};
const Kind kKinds[] = {{5120, 127}, {5121, 255}, {5122, 32767}, {5123, 65535}};

}  // namespace

TEST_CASE("an accessor of whole numbers begins where its offset says") {
    const Folder folder;
    Values five = scaled(kSquare, 5122, 100, false);
    five.value.insert(five.value.begin(), {9000, 9000, 9000});  // not of it
    Document document = document_of({five}, R"(,"uri":"my%20data.bin")");
    const std::string all = R"("bufferView":0,"componentType":5122,"count":5)";
    REQUIRE(document.json.find(all) != std::string::npos);
    document.json.replace(document.json.find(all), all.size(),
                          R"("bufferView":0,"byteOffset":8,"componentType":5122,"count":4)");
    folder.write("my data.bin", document.bin);
    const TriMesh mesh = test::read_quietly(folder.write("a.gltf", document.json));
    CHECK(box_of(mesh.position).low == Vec3::Zero());
    CHECK(box_of(mesh.position).high == Vec3(100, 100, 0));
}

TEST_CASE("a mirrored glTF keeps its normals, mirrored with it") {
    const Folder folder;
    Values normal{"NORMAL", 5126, 3, {}};
    for (int n = 0; n < 4; ++n) normal.value.insert(normal.value.end(), {0.6, 0, 0.8});
    for (const double scale : {1.0, -1.0}) {
        const TriMesh mesh =
            read(folder, {kSquare, normal}, "", fmt::format(R"(,"scale":[{},1,1])", scale)).mesh;
        const Vec3 out = area_vector(mesh.position, mesh.triangle[0]);
        CHECK(out.z() > 0);
        REQUIRE(mesh.smooth_normal.size() == std::size_t(mesh.smooth_group_count));
        for (const Vec3& n : mesh.smooth_normal) {
            CHECK((n - Vec3(0.6 * scale, 0, 0.8)).norm() < 1e-6);
        }
    }
}

TEST_CASE("whole numbers in a glTF stand for what its specification says") {
    const Folder folder;
    const Values uv{"TEXCOORD_0", 5126, 2, {0, 1, 1, 1, 1, 0, 0, 0}};
    const Values normal{"NORMAL", 5126, 3, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}};
    const Reading plain = read(folder, {kSquare, normal, uv});
    REQUIRE(plain.mesh.uv.size() == 4);
    REQUIRE(plain.mesh.triangle.size() == 2);
    const std::string extension =
        R"("extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"],)";
    for (const auto& [type, most] : kKinds) {
        CAPTURE(type);
        const Reading parts = read(folder,
                                   {scaled(kSquare, type, most, true),
                                    scaled(normal, type, most, true), scaled(uv, type, most, true)},
                                   extension);
        CHECK(parts.mesh.position == plain.mesh.position);
        CHECK(parts.mesh.uv == plain.mesh.uv);
        CHECK(parts.mesh.triangle_smooth == plain.mesh.triangle_smooth);
        CHECK(parts.finding.empty());
        // As they stand: the node scales them.
        const Reading counts =
            read(folder, {scaled(kSquare, type, 100, false), scaled(uv, type, 3, false)}, extension,
                 R"(,"scale":[0.5,0.5,0.5])");
        CHECK(box_of(counts.mesh.position).high == Vec3(50, 50, 0));
        CHECK(counts.mesh.uv[0] == Vec2(0, -2));  // counted from below: 1 - 3
        CHECK(counts.mesh.uv[2] == Vec2(3, 1));
    }
    // -128 is no less than -127.
    Values low = scaled(kSquare, 5120, 127, true);
    low.value[0] = -128;
    CHECK(box_of(read(folder, {low}, extension).mesh.position).low.x() == -1);
}

TEST_CASE("a glTF's colours are the same in bytes, 16 bits and floats, with and without alpha") {
    const Folder folder;
    const Values color{"COLOR_0", 5126, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.2, 0.4, 0.6}};
    Values with_alpha{"COLOR_0", 5126, 4, {}};
    for (std::size_t i = 0; i < 12; ++i) {
        with_alpha.value.push_back(color.value[i]);
        if (i % 3 == 2) with_alpha.value.push_back(1);
    }
    for (const Values& values : {color, with_alpha})
        for (const auto& [type, most] : {kKinds[1], kKinds[3], Kind{5126, 1}}) {
            CAPTURE(values.width, type);
            const TriMesh mesh = read(folder, {kSquare, scaled(values, type, most, true)}).mesh;
            REQUIRE(mesh.position_color.size() == 4);
            CHECK(mesh.position_color[0] == Eigen::Vector3f(1, 0, 0));
            CHECK(mesh.position_color[2] == Eigen::Vector3f(0, 0, 1));
            CHECK((mesh.position_color[3] - Eigen::Vector3f(0.2f, 0.4f, 0.6f)).norm() < 2e-5f);
        }
}

TEST_CASE("whole numbers in a glTF that reach beyond their data are refused") {
    const Folder folder;
    Document document = document_of({scaled(kSquare, 5123, 1, false)}, R"(,"uri":"a.bin")");
    folder.write("a.bin", document.bin);
    const std::size_t at = document.json.find(R"("count":4)");
    document.json.replace(at, 9, R"("count":5)");
    CHECK_THROWS_WITH(test::read_quietly(folder.write("a.gltf", document.json)),
                      Catch::Contains("buffer view 0 is shorter than what is read from it"));
}

TEST_CASE("a glTF extension that nobody follows is told of, and refused where the mesh needs it") {
    const Folder folder;
    CHECK_THROWS_WITH(
        read(folder, {kSquare}, R"("extensionsRequired":["EXT_meshopt_compression","X_y"],)"),
        Catch::Contains("requires 'EXT_meshopt_compression', 'X_y', which is not supported"));
    const Reading looks =
        read(folder, {kSquare}, R"("extensionsRequired":["KHR_materials_transmission"],)");
    REQUIRE(looks.finding.size() == 1);
    CHECK(looks.finding[0] ==
          "it uses 'KHR_materials_transmission', which is not supported: it may look different");
}

TEST_CASE("of a glTF's opacity the reader tells") {
    const Folder folder;
    CHECK(read(folder, {kSquare}, R"("materials":[{"name":"wall"},{"alphaMode":"OPAQUE"}],)")
              .finding.empty());
    const Reading pane = read(
        folder, {kSquare}, R"("materials":[{"name":"wall"},{"name":"pane","alphaMode":"BLEND"}],)");
    REQUIRE(pane.finding.size() == 1);
    CHECK(pane.finding[0] == "the material 'pane' transmits light (alphaMode): drawn opaque");
}

TEST_CASE("of a glTF's own light, and of images that do not repeat, the reader tells") {
    const Folder folder;
    const auto findings = [&](const std::string& material, const std::string& sampler) {
        return read(folder, {kSquare},
                    fmt::format(R"("images":[{{"uri":"a.png"}}],"samplers":[{{{}}}],
"textures":[{{"source":0}},{{"source":0,"sampler":0}}],"materials":[{{"name":"lamp",{}}}],)",
                                sampler, material))
            .finding;
    };
    const std::string image = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":1}})";
    CHECK(findings(image + R"(,"emissiveFactor":[0,0,0],"emissiveTexture":{"index":0})",
                   R"("wrapS":10497)")
              .empty());
    CHECK(findings(R"("emissiveFactor":[0,0.5,0])", "") ==
          std::vector<std::string>{
              "the material 'lamp' emits light (emissiveFactor): drawn without that light"});
    CHECK(findings(image, R"("wrapT":33071)") ==
          std::vector<std::string>{"the material 'lamp' does not repeat its image beyond the "
                                   "borders (wrapS, wrapT): drawn repeated"});
}

TEST_CASE("instances of a glTF's mesh stand at all their places") {
    const Folder folder;
    const Values at{"", 5126, 3, {0, 0, 0, 2, 0, 0, 4, 0, 3}};
    const double half = std::sqrt(0.5) * 32767;
    const Values turned{"", 5122, 4, {0, 0, 0, 32767, 0, 0, 0, 32767, 0, 0, half, half}, true};
    const Reading row =
        read(folder, {kSquare, at, turned}, R"("extensionsRequired":["EXT_mesh_gpu_instancing"],)",
             R"(,"name":"tile","translation":[0,10,0],"extensions":{"EXT_mesh_gpu_instancing":
{"attributes":{"TRANSLATION":1,"ROTATION":2}}})");
    CHECK(row.mesh.triangle.size() == 6);
    CHECK(row.mesh.part_name == std::vector<std::string>{"tile", "tile.2", "tile.3"});
    const Box box = box_of(row.mesh.position);
    CHECK((box.low - Vec3(0, 10, 0)).norm() < 1e-4);
    CHECK((box.high - Vec3(4, 11, 3)).norm() < 1e-4);  // the last is turned to the left
    CHECK(row.finding.empty());
}

TEST_CASE("texture coordinates are of the set that a material's image lies by") {
    const Folder folder;
    const auto set = [](const char* name, double scale) {
        return Values{name, 5126, 2, {0, 0, scale, 0, scale, scale, 0, scale}};
    };
    const std::string image = R"("index":0)";
    std::string json, materials;
    for (const std::string& by :
         {image, image + R"(,"texCoord":1)",
          image + R"(,"extensions":{"KHR_texture_transform":{"texCoord":2}})",
          image + R"(,"texCoord":7)"})
        materials +=
            fmt::format(R"({}{{"name":"m","pbrMetallicRoughness":{{"baseColorTexture":{{{}}}}}}})",
                        materials.empty() ? "" : ",", by);
    const Document document = document_of(
        {kSquare, set("TEXCOORD_0", 1), set("TEXCOORD_1", 0.5), set("TEXCOORD_2", 0.25)},
        R"(,"uri":"data.bin")",
        R"("textures":[{"source":0}],"images":[{"uri":"a.png"}],"extensionsUsed":
["KHR_texture_transform"],"materials":[)" +
            materials + "],");
    const std::string before = R"("primitives":[)";
    json = document.json;
    const std::size_t at = json.find(before) + before.size();
    const std::string one = json.substr(at, json.find("]}]", at) - at);
    std::string all;
    for (int m = 0; m < 4; ++m)
        all += fmt::format(R"({}{{"material":{},{})", m > 0 ? "," : "", m, one.substr(1));
    json.replace(at, one.size(), all);
    folder.write("data.bin", document.bin);
    folder.write("a.png", "png");
    const TriMesh mesh = test::read_quietly(folder.write("a.gltf", json));
    REQUIRE(mesh.triangle.size() == 8);
    const double scale[] = {1, 0.5, 0.25, 1};
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3& p = mesh.position[mesh.triangle[t][k]];
            const Vec2& uv = mesh.uv[mesh.triangle_uv[t][k]];
            const double s = scale[mesh.triangle_material[t]];
            CHECK((Vec2(uv.x(), 1 - uv.y()) - s * Vec2(p.x(), p.y())).norm() < 1e-6);
        }
}
