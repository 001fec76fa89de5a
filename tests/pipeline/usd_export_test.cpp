// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/usd_export.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "base/error.h"
#include "base/text.h"
#include "geometry/box_mesh.h"
#include "geometry/mesh_looks.h"
#include "tests/catch.h"
#include "tests/pipeline/pyramid.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/meshes.h"
#include "tests/shared/scratch.h"
#include "tests/shared/usda.h"

using namespace swage;
using test::bytes_of;
namespace fs = std::filesystem;

namespace {

constexpr int kFrames = 8, kCut = 5;  // the frame that has another skin
const std::string kBody = "/two_falls/a_body";

// With the square as one polygon, a corner that has no place in the image, and a place that none
// has.
TriMesh pyramid(const fs::path& texture) {
    TriMesh mesh = test::pyramid(texture);
    mesh.triangle_polygon = {0, 0, 1, 2};
    mesh.uv.emplace_back(7, 7);
    mesh.triangle_uv[3][2] = -1;
    return mesh;
}

TriMesh cut_pyramid(const fs::path& texture) {
    TriMesh mesh = test::with_cut(pyramid(texture));
    mesh.triangle_polygon.push_back(3);
    return mesh;
}

TriMesh colored() {
    TriMesh mesh = pyramid({});
    mesh.material.clear();
    mesh.triangle_material.clear();
    mesh.position_color.assign(5, Eigen::Vector3f(0.25f, 0.5f, 1));
    return mesh;
}

std::vector<Vec3> moved(std::vector<Vec3> position, const Vec3& way) {
    for (Vec3& p : position) p += way;
    return position;
}

// Written as one body that does not move, or has one skin after the other.
std::string exported(const fs::path& folder, const std::vector<TriMesh>& skins) {
    {
        FrameStoreWriter writer(folder / "motion.bin");
        for (const TriMesh& skin : skins) writer.add_skin(skin);
        for (std::size_t n = 0; n < skins.size(); ++n) {
            StoredFrame now;
            now.body = {{static_cast<int>(n), skins[n].position}};
            writer.add_frame(now);
        }
        writer.finish();
    }
    const fs::path file = folder / "out" / "x.usda";
    export_usd(FrameStore(folder / "motion.bin"), {"run", {"one"}},
               {1, static_cast<int>(skins.size())}, file);
    return bytes_of(file);
}

// One falls and is cut, one stays but in frame 6, one stays.
struct Motion {
    Scratch scratch;
    std::vector<StoredFrame> frame;
    std::vector<TriMesh> skin;
    ExportScene scene{"two-falls", {"a body", "a-body", "3rd"}};

    Motion() {
        scene.render.frame_rate = {24, 1};
        const fs::path texture = scratch.path() / "spots of it.png";
        std::ofstream(texture) << "\x89PNG of spots";
        skin = {pyramid(texture), cut_pyramid(texture), colored()};
        FrameStoreWriter writer(store());
        for (const TriMesh& one : skin) writer.add_skin(one);
        for (int f = 1; f <= kFrames; ++f) {
            const int first = f < kCut ? 0 : 1;
            StoredFrame now;
            now.body = {{first, moved(skin[first].position, {0, -0.1 * f * f, 0})},
                        {0, moved(skin[0].position, {0, 0, f == 6 ? 2.0 : 0.0})},
                        {2, skin[2].position}};
            writer.add_frame(now);
            frame.push_back(now);
        }
        writer.finish();
    }
    fs::path store() const { return scratch.path() / "motion.bin"; }
    fs::path file() const { return scratch.path() / "out" / "x.usda"; }
    ExportOutcome write(const FrameRange& frames = {1, kFrames}) const {
        return export_usd(FrameStore(store()), scene, frames, file());
    }
    Usda written(const FrameRange& frames = {1, kFrames}) const {
        write(frames);
        return Usda(bytes_of(file()));
    }
};

}  // namespace

TEST_CASE("fields of the matter are values of the vertices in USD") {
    const Scratch scratch;
    const TriMesh mesh = colored();
    const auto values = [&](int frame) {  // the same in the first two
        std::vector<float> all(mesh.position.size(), 0.25f);
        all[1] = static_cast<float>(std::max(2, frame));
        return all;
    };
    {
        FrameStoreWriter writer(scratch.path() / "motion.bin",
                                {SkinField::plastic_strain, SkinField::pressure});
        writer.add_skin(mesh);
        for (int f = 1; f <= 4; ++f) {
            StoredFrame now;
            now.body = {{0, mesh.position, {values(f), values(5)}}};
            writer.add_frame(now);
        }
        writer.finish();
    }
    const fs::path file = scratch.path() / "out" / "x.usda";
    export_usd(FrameStore(scratch.path() / "motion.bin"), {"run", {"one"}}, {1, 4}, file);
    const Usda usd(bytes_of(file));
    for (int f = 1; f <= 4; ++f) {
        CHECK(usd.numbers("/run/one.primvars:plastic_strain", f) == values(f));
        CHECK(usd.numbers("/run/one.primvars:pressure", f) == values(5));
    }
    CHECK(bytes_of(file).find("primvars:plastic_strain (interpolation = \"vertex\")") !=
          std::string::npos);
}

TEST_CASE("how large a file of USD becomes is known before it is written, about") {
    const Scratch scratch;
    TriMesh ball = test::sphere_mesh(0.0123456789, 3);
    smooth_by_crease_angle(ball);
    const bool is_dressed = GENERATE(false, true);
    if (is_dressed) {
        for (const Vec3& p : ball.position) ball.uv.emplace_back(70.7 * p.x(), 70.7 * p.y());
        ball.triangle_uv = ball.triangle;
    }
    std::vector<SkinField> fields;
    if (is_dressed) fields = {SkinField::stress};
    {
        FrameStoreWriter writer(scratch.path() / "motion.bin", fields);
        writer.add_skin(ball);
        for (int f = 1; f <= 5; ++f) {
            StoredFrame now;
            now.body = {{0, moved(ball.position, {0.1 / f, 0.01 * f, 0})}};
            if (is_dressed) {
                now.body[0].field.resize(1);
                for (const Vec3& p : ball.position) {
                    now.body[0].field[0].push_back(float(1e8 * f * std::abs(p.x())));
                }
            }
            writer.add_frame(now);
        }
        writer.finish();
    }
    const ExportOutcome outcome = export_usd(FrameStore(scratch.path() / "motion.bin"),
                                             {"run", {"ball"}}, {1, 5}, scratch.path() / "x.usda");
    CHECK(outcome.expected > 0.8 * double(outcome.bytes));
    CHECK(outcome.expected < 1.4 * double(outcome.bytes));
}

TEST_CASE("of a run in USD every frame has the faces and the places of its skins") {
    const Motion motion;
    const Usda usd = motion.written();
    const FrameStore store(motion.store());
    const std::vector<std::string> body = {"a_body", "a_body_2", "_3rd"};
    for (int f = 1; f <= kFrames; ++f) {
        const StoredFrame frame = store.frame(f - 1);
        for (std::size_t b = 0; b < body.size(); ++b) {
            const std::string path = "/two_falls/" + body[b];
            REQUIRE(usd.kind(path) == "Mesh");
            std::vector<float> expected;
            for (const Vec3& p : frame.body[b].position) {
                for (int k = 0; k < 3; ++k) expected.push_back(static_cast<float>(p[k]));
            }
            CHECK(usd.numbers(path + ".points", f) == expected);
            const std::vector<float> extent = usd.numbers(path + ".extent", f);
            REQUIRE(extent.size() == 6);
            for (std::size_t i = 0; i < expected.size(); ++i) {
                CHECK(extent[i % 3] <= expected[i]);
                CHECK(extent[3 + i % 3] >= expected[i]);
            }
            std::vector<float> counts = {4, 3, 3}, corners = {0, 3, 2, 1, 0, 1, 4, 1, 2, 4};
            if (b == 0 && f >= kCut) {
                counts.push_back(3);
                corners.insert(corners.end(), {2, 3, 4});
            }
            CHECK(usd.numbers(path + ".faceVertexCounts", f) == counts);
            CHECK(usd.numbers(path + ".faceVertexIndices", f) == corners);
            CHECK(usd.numbers(path + ".primvars:normals:indices", f).size() == corners.size());
        }
    }
}

TEST_CASE("points of a body whose faces change have their velocity in USD, in units per second") {
    const Motion motion;
    for (const FrameRange& frames : {FrameRange{1, kFrames}, FrameRange{3, 6}}) {
        const Usda usd = motion.written(frames);
        CHECK(usd.times(kBody + ".velocities") == usd.times(kBody + ".points"));
        for (int f = frames.first; f <= frames.last; ++f) {
            const auto velocity = usd.numbers(kBody + ".velocities", f);
            REQUIRE(velocity.size() == usd.numbers(kBody + ".points", f).size());
            // It has fallen by f * f / 10, at 24 frames a second; over the cut too.
            const int from = std::min(f, kFrames - 1);
            for (std::size_t i = 0; i < velocity.size(); ++i) {
                const double expected = i % 3 == 1 ? -2.4 * (2 * from + 1) : 0;
                CHECK_THAT(velocity[i], Catch::Matchers::WithinAbs(expected, 1e-4));
            }
        }
        // Readers find that of the others between their samples.
        CHECK_FALSE(usd.has("/two_falls/a_body_2.velocities"));
        CHECK_FALSE(usd.has("/two_falls/_3rd.velocities"));
    }
    CHECK_FALSE(motion.written({1, kCut - 1}).has(kBody + ".velocities"));
}

TEST_CASE("a body that comes apart has the numbers of its pieces at its faces in USD") {
    const Scratch scratch;
    const TriMesh whole = box_mesh(Vec3(0, 0, 0), Vec3(3, 1, 1));
    TriMesh parted = box_mesh(Vec3(0, 0, 0), Vec3(1, 1, 1));  // the smaller first
    const TriMesh rest = box_mesh(Vec3(1, 0, 0), Vec3(3, 1, 1));
    const int before = static_cast<int>(parted.position.size());
    const std::size_t small = parted.triangle.size();
    parted.position.insert(parted.position.end(), rest.position.begin(), rest.position.end());
    for (const Corners& t : rest.triangle) {
        parted.triangle.push_back({t[0] + before, t[1] + before, t[2] + before});
    }
    TriMesh plain[] = {whole, parted};
    for (TriMesh& one : plain) {  // triangles alone
        TriMesh bare;
        bare.position = one.position;
        bare.triangle = one.triangle;
        one = bare;
    }
    const Usda usd(exported(scratch.path(), {plain[0], plain[1]}));
    CHECK(usd.times("/run/one.primvars:piece") == std::vector<int>{1, 2});
    CHECK(usd.numbers("/run/one.primvars:piece", 1) ==
          std::vector<float>(whole.triangle.size(), 1));
    std::vector<float> expected(small, 2);
    expected.resize(parted.triangle.size(), 1);  // of the larger
    CHECK(usd.numbers("/run/one.primvars:piece", 2) == expected);
    CHECK(bytes_of(scratch.path() / "out" / "x.usda")
              .find("primvars:piece (interpolation = \"uniform\")") != std::string::npos);
    // A body that only gets other faces is one piece.
    CHECK_FALSE(Motion().written().has(kBody + ".primvars:piece"));
}

TEST_CASE("corners have their place in the image and their normal, those without lie at 0, 0") {
    const Motion motion;
    const Usda usd = motion.written();
    for (const int f : {kCut - 1, kCut, kFrames}) {
        const auto at = usd.numbers(kBody + ".primvars:st:indices", f);
        const auto st = usd.numbers(kBody + ".primvars:st", f);
        REQUIRE(st.size() == (f < kCut ? 6 : 12));  // what no corner has is left out
        std::vector<float> u;
        for (const float i : at) u.push_back(st[2 * std::size_t(i)]);
        std::vector<float> expected = {0.5f, 1, 1, 1, 0.5f, 1, 0.5f, 0.5f, 1, 0};
        if (f >= kCut) expected.insert(expected.end(), {1, 0, 0.1f});  // x at molding
        CHECK(u == expected);
        const auto which = usd.numbers(kBody + ".primvars:normals:indices", f);
        const auto normal = usd.numbers(kBody + ".primvars:normals", f);
        const std::size_t down = 3 * std::size_t(which[0]);
        CHECK(std::vector<float>(normal.begin() + long(down), normal.begin() + long(down) + 3) ==
              std::vector<float>{0, 0, -1});
    }
    CHECK(usd.numbers("/two_falls/_3rd.primvars:displayColor", 1) ==
          std::vector<float>{0.2f, 0.4f, 0.8f, 0.2f, 0.4f, 0.8f, 0.2f, 0.4f, 0.8f, 0.2f, 0.4f, 0.8f,
                             0.2f, 0.4f, 0.8f});  // times that of what has no material
}

TEST_CASE("what does not change is written once, and what stays has a sample before it goes on") {
    const Motion motion;
    const Usda usd = motion.written();
    const std::vector<int> none, cut = {1, kCut}, held = {1, kCut - 1, kCut};
    const std::string still = "/two_falls/_3rd", waits = "/two_falls/a_body_2";
    for (const char* one : {".points", ".extent", ".faceVertexIndices", ".primvars:normals"}) {
        CHECK(usd.times(still + one) == none);
    }
    CHECK(usd.times(waits + ".faceVertexIndices") == none);
    CHECK(usd.times(waits + ".points") == std::vector<int>{1, 5, 6, 7});
    CHECK(usd.times(waits + ".primvars:normals") == std::vector<int>{1, 5, 6, 7});
    CHECK(usd.times(kBody + ".points").size() == kFrames);
    CHECK(usd.times(kBody + ".faceVertexIndices") == cut);
    CHECK(usd.times(kBody + ".primvars:st:indices") == cut);
    CHECK(usd.times(kBody + ".primvars:st") == held);  // a reader goes straight between samples
}

TEST_CASE("every face has the material of the skin, a textured one its image beside the file") {
    const Motion motion;
    const ExportOutcome outcome = motion.write();
    const Usda usd(bytes_of(motion.file()));
    CHECK(outcome.bodies == 3);
    CHECK(outcome.bytes == fs::file_size(motion.file()));
    REQUIRE(outcome.image == std::vector<std::string>{"spots_of_it.png"});
    CHECK(bytes_of(motion.file().parent_path() / outcome.image[0]) == "\x89PNG of spots");
    const std::string looks = "/two_falls/materials/";
    CHECK(usd.text(looks + "hide/image.inputs:file") == "@./spots_of_it.png@");
    CHECK(usd.text(looks + "cut/surface.inputs:diffuseColor") == "(0.5, 0.25, 1)");
    // What lets light through is open by that; all else says nothing of it.
    CHECK(usd.text(looks + "cut/surface.inputs:opacity") == "0.25");
    CHECK_FALSE(usd.has(looks + "hide/surface.inputs:opacity"));
    // What reads no parts of a mesh has the look of most of it.
    CHECK(usd.text(kBody + ".material:binding") == "<" + looks + "hide>");
    CHECK(bytes_of(motion.file())
              .find("(0.8, 0.8, 0.8)] (\n            interpolation = "
                    "\"constant\"") != std::string::npos);
    CHECK(usd.numbers(kBody + ".primvars:displayColor", 1) == std::vector<float>{0.8f, 0.8f, 0.8f});
    // A face that has no place in the image has the colour alone.
    CHECK(usd.has(looks + "hide_2/surface.inputs:diffuseColor"));
    CHECK(usd.text(kBody + "/hide.material:binding") == "<" + looks + "hide>");
    CHECK(usd.text(kBody + "/cut.material:binding") == "<" + looks + "cut>");
    for (int f = 1; f <= kFrames; ++f) {
        CHECK(usd.numbers(kBody + "/hide.indices", f) == std::vector<float>{0, 1});
        CHECK(usd.numbers(kBody + "/hide_2.indices", f) == std::vector<float>{2});
        CHECK(usd.numbers(kBody + "/cut.indices", f) ==
              (f < kCut ? std::vector<float>{} : std::vector<float>{3}));
    }
    CHECK(usd.text(kBody + ".doubleSided") == "1");
}

TEST_CASE("a file of USD says its units, its times and what is upward in it") {
    Motion motion;
    const Usda usd = motion.written({3, 6});
    CHECK(usd.text(".metersPerUnit") == "1");
    CHECK(usd.text(".startTimeCode") == "3");
    CHECK(usd.text(".endTimeCode") == "6");
    CHECK(usd.text(".timeCodesPerSecond") == "24");
    CHECK(usd.text(".upAxis") == "\"Y\"");
    CHECK(usd.text(".defaultPrim") == "\"two_falls\"");
    CHECK(usd.times(kBody + ".points") == std::vector<int>{3, 4, 5, 6});
    motion.scene.render.up = Up::z;
    CHECK(motion.written().text(".upAxis") == "\"Z\"");
    const std::string once = bytes_of(motion.file());
    motion.write();
    CHECK(bytes_of(motion.file()) == once);
}

TEST_CASE("what is upward along x is turned so that it is along y in a file of USD") {
    Motion motion;
    const double sign = GENERATE(1.0, -1.0);
    motion.scene.render.up = sign > 0 ? Up::x : Up::minus_x;
    const std::vector<float> row = motion.written().numbers("/two_falls.xformOp:transform", 1);
    REQUIRE(row.size() == 16);
    const auto at = [&](std::size_t axis) {
        return Vec3(row[4 * axis], row[4 * axis + 1], row[4 * axis + 2]);
    };
    CHECK(at(0) == sign * Vec3::UnitY());
    CHECK(at(0).dot(at(1).cross(at(2))) == 1);
    CHECK(at(3) == Vec3::Zero());
    CHECK(motion.written().text(".upAxis") == "\"Y\"");
}

TEST_CASE("an export gives way to another, nothing else does, and one that fails leaves nothing") {
    Motion motion;
    const auto refused = [&](const FrameRange& frames, ExitCode code) {
        try {
            motion.write(frames);
            return false;
        } catch (const Error& error) {
            return error.code() == code;
        }
    };
    CHECK(refused({1, kFrames + 1}, ExitCode::command_line));
    fs::remove(motion.scratch.path() / "spots of it.png");
    CHECK(refused({1, kFrames}, ExitCode::output));
    CHECK_FALSE(fs::exists(motion.file().parent_path()));
    fs::create_directory(motion.file().parent_path());
    std::ofstream(motion.file()) << "#usda 1.0\n(\n    doc = \"my own\"\n)\n";
    const std::string mine = bytes_of(motion.file());
    CHECK(refused({1, kFrames}, ExitCode::foreign));
    CHECK(bytes_of(motion.file()) == mine);
}

TEST_CASE("colours of vertices are those of their material times theirs in USD") {
    const Scratch scratch;
    TriMesh mesh = colored();
    mesh.material = {{.name = "coat", .color = {0.2, 0.2, 0.5}}};
    mesh.triangle_material.assign(mesh.triangle.size(), 0);
    const std::string text = exported(scratch.path(), {mesh});
    const Usda usd(text);
    std::vector<float> expected;
    for (int v = 0; v < 5; ++v) expected.insert(expected.end(), {0.05f, 0.1f, 0.5f});
    CHECK(usd.numbers("/run/one.primvars:displayColor", 1) == expected);
    CHECK(text.find("interpolation = \"vertex\"") != std::string::npos);
    CHECK_FALSE(usd.has("/run/one.primvars:displayColor:indices"));
    CHECK(usd.text("/run/materials/coat/surface.inputs:diffuseColor.connect") ==
          "</run/materials/coat/colors.outputs:result>");
}

TEST_CASE("faces that take no colours of vertices have their own in USD, also at their rim") {
    const Scratch scratch;
    TriMesh mesh = pyramid({}), cut = cut_pyramid({});
    for (TriMesh* one : {&mesh, &cut}) one->position_color.assign(5, {0.25f, 0.5f, 1});
    cut.position_color[0] = {1, 0, 0};
    const std::string text = exported(scratch.path(), {mesh, cut});
    const Usda usd(text);
    for (const int f : {1, 2}) {
        const auto value = usd.numbers("/run/one.primvars:displayColor", f);
        const auto index = usd.numbers("/run/one.primvars:displayColor:indices", f);
        const auto corner = usd.numbers("/run/one.faceVertexIndices", f);
        REQUIRE(index.size() == corner.size());
        CHECK(value.size() == (f == 1 ? 3 : 9));  // each once
        for (std::size_t i = 0; i < corner.size(); ++i) {
            INFO(f << " " << i);
            std::vector<float> expected = {0.2f, 0.4f, 0.8f};
            if (f == 2 && corner[i] == 0) expected = {0.8f, 0, 0};
            if (f == 2 && i >= 10) expected = {0.5f, 0.25f, 1};
            const auto at = value.begin() + 3 * long(index[i]);
            CHECK(std::vector<float>(at, at + 3) == expected);
        }
    }
    CHECK(usd.times("/run/one.primvars:displayColor:indices") == std::vector<int>{1, 2});
    CHECK(text.find("primvars:displayColor (interpolation = \"faceVarying\")") !=
          std::string::npos);
}

TEST_CASE("an image is as much darker in USD as the colour that all its vertices have") {
    const Scratch scratch;
    const fs::path texture = scratch.path() / "spots.png";
    std::ofstream(texture) << "\x89PNG of spots";
    TriMesh mesh = pyramid(texture);
    mesh.position_color.assign(5, {0.25f, 0.5f, 1});
    const bool is_uniform = GENERATE(true, false);
    if (!is_uniform) mesh.position_color[1] = {1, 1, 1};
    MeshLooks looks(false);
    looks.of_polygons(mesh, rejoin_polygons(mesh));
    CHECK(looks.without_colors() ==
          (is_uniform ? std::set<std::string>{} : std::set<std::string>{"hide"}));
    const Usda usd(exported(scratch.path(), {mesh}));
    CHECK(usd.numbers("/run/materials/hide/image.inputs:scale", 1) ==
          (is_uniform ? std::vector<float>{0.2f, 0.4f, 0.8f, 1}
                      : std::vector<float>{0.8f, 0.8f, 0.8f, 1}));
}

TEST_CASE("a material keeps its name in USD where that is no identifier") {
    const Scratch scratch;
    TriMesh mesh = pyramid({});
    mesh.material[0].name = "raw hide";
    const Usda usd(exported(scratch.path(), {mesh}));
    REQUIRE(usd.kind("/run/materials/raw_hide") == "Material");
    CHECK(usd.text("/run/materials.name") == "\"raw hide\"");
}
