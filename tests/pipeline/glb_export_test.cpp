// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/glb_export.h"

#include <fstream>

#include "base/error.h"
#include "geometry/box_mesh.h"
#include "pipeline/shot.h"
#include "tests/pipeline/glb.h"
#include "tests/pipeline/pyramid.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"

using namespace swage;
using test::bytes_of;
using test::Glb;
namespace fs = std::filesystem;

namespace {

constexpr int kFrames = 8, kCut = 5, kSecond = 4;  // first frames of another skin and machine
constexpr double kRate = 24;

double time_of(int frame) { return (frame - 1) / kRate; }

TriMesh colored() {
    TriMesh mesh = box_mesh(Vec3(0, 0, 0), Vec3(1, 1, 1));
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
        mesh.position_color.emplace_back(0.25f, 0.125f * float(v), 1.0f);
    }
    mesh.triangle_smooth.clear();
    mesh.smooth_group_count = 0;
    return mesh;
}

// The first bends and is cut, the second stays but in frame 6; two machines, whose tool turns.
struct Motion {
    Scratch scratch;
    std::vector<TriMesh> skin;
    TriMesh tool = box_mesh(Vec3(-0.1, -0.2, -0.3), Vec3(0.1, 0.2, 0.3));
    ExportScene scene{"two", {"first", "second"}};

    Motion() {
        scene.render.frame_rate = {24, 1};
        scene.stage = {{"1-bend", kSecond - 1}, {"2-drop", kFrames}};
        const fs::path texture = scratch.path() / "spots.png";
        std::ofstream(texture) << "\x89PNG of spots";
        const TriMesh whole = test::pyramid(texture);
        skin = {whole, test::with_cut(whole), colored()};
        FrameStoreWriter writer(store());
        for (const TriMesh& one : skin) writer.add_skin(one);
        writer.add_machine({{"post", tool, {0.25, 0.5, 0.75}}});
        writer.add_machine({{"blade", tool, {0.75, 0.5, 0.5}, Finish::matt}});
        for (int f = 1; f <= kFrames; ++f) {
            const int first = f < kCut ? 0 : 1;
            StoredFrame now;
            now.body = {{first, skin[first].position}, {2, skin[2].position}};
            for (Vec3& p : now.body[0].position) {
                p = turn_about(Vec3(1, 1, 0).normalized(), 0.3 * f * (1 + p.z())) * p;
            }
            if (f == 6) now.body[1].position[0] += Vec3(0, 0, 2);
            now.machine = f < kSecond ? 0 : 1;
            now.pose = {{turn_about(Vec3(1, 2, 3).normalized(), 0.9 * f), Vec3(0.3 * f, 1, -0.1)}};
            writer.add_frame(now);
        }
        writer.finish();
    }
    fs::path store() const { return scratch.path() / "motion.bin"; }
    fs::path file() const { return scratch.path() / "out" / "x.glb"; }
    Glb written(const FrameRange& frames = {1, kFrames}) const {
        export_glb(FrameStore(store()), scene, frames, file());
        return Glb(bytes_of(file()));
    }
};

}  // namespace

TEST_CASE("of a run in glTF every frame has the places and the normals of its skins") {
    const Motion motion;
    const Glb glb = motion.written();
    const FrameStore store(motion.store());
    for (int f = 1; f <= kFrames; ++f) {
        CAPTURE(f);
        const double t = time_of(f);
        CHECK(glb.is_shown(glb.node("first-1"), t) == (f < kCut));
        CHECK(glb.is_shown(glb.node("first-2"), t) == (f >= kCut));
        CHECK(glb.is_shown(glb.node("second"), t));
        const StoredFrame frame = store.frame(f - 1);
        for (const std::size_t b : {0u, 1u}) {
            const TriMesh& skin = motion.skin[std::size_t(frame.body[b].skin)];
            const int node = glb.node(b == 1 ? "second" : f < kCut ? "first-1" : "first-2");
            const std::size_t looks = b == 0 && f >= kCut ? 2 : 1;
            std::vector<Vec3> place, normal;
            for (std::size_t p = 0; p < looks; ++p) {
                for (const Vec3& at : glb.corners(node, p, "POSITION", t)) place.push_back(at);
                if (b == 1) continue;
                for (const Vec3& at : glb.corners(node, p, "NORMAL", t)) normal.push_back(at);
            }
            REQUIRE(place.size() == 3 * skin.triangle.size());
            std::vector<Vec3> smooth;
            if (b == 0) smooth = smooth_normals(skin, frame.body[b].position);
            for (std::size_t n = 0; n < place.size(); ++n) {
                const auto v = std::size_t(skin.triangle[n / 3][n % 3]);
                CHECK((place[n] - frame.body[b].position[v]).norm() < 3e-7);
                if (b == 1) continue;
                const auto group = std::size_t(skin.triangle_smooth[n / 3][n % 3]);
                CHECK((normal[n] - smooth[group]).norm() < 1e-6);
            }
        }
    }
    // What stays has no shapes, what moves once two, there and back.
    const auto shapes = [&](const char* name) {
        return glb.value(glb.node(name), "weights", 0).size();
    };
    CHECK(shapes("second") == 2);
    CHECK(shapes("first-1") == kCut - 2);
    const double held = 0.5 * (time_of(4) + time_of(5));  // not on its way to frame 6 yet
    CHECK(glb.value(glb.node("second"), "weights", held) == std::vector<float>{0, 0});
    // Half-way between two frames a reader is half-way.
    const double half = 0.5 * (time_of(2) + time_of(3));
    const std::vector<float> weight = glb.value(glb.node("first-1"), "weights", half);
    CHECK(weight[0] == Approx(0.5f).margin(1e-4));
    CHECK(weight[1] == Approx(0.5f).margin(1e-4));
}

TEST_CASE("in glTF tools stand where the run has them, as long as their stage lasts") {
    const Motion motion;
    const Glb glb = motion.written();
    const FrameStore store(motion.store());
    for (int f = 1; f <= kFrames; ++f) {
        const bool is_second = f >= kSecond;
        CHECK(glb.is_shown(glb.node("post"), time_of(f)) == !is_second);
        CHECK(glb.is_shown(glb.node("blade"), time_of(f)) == is_second);
        const int node = glb.node(is_second ? "blade" : "post");
        const Eigen::Matrix4d world = glb.world_from_node(node, time_of(f));
        const Pose pose = store.frame(f - 1).pose.at(0);
        CHECK((world.block<3, 3>(0, 0) - pose.rotation.toRotationMatrix()).norm() < 1e-6);
        CHECK((world.block<3, 1>(0, 3) - pose.translation).norm() < 1e-6);
        CHECK(glb.corners(node, 0, "POSITION", 0).size() == 36);
    }
    // Turns of 0.9 each: half-way the turn is half as far on, not the long way round.
    const double half = 0.5 * (time_of(6) + time_of(7));
    const Mat3 between = glb.world_from_node(glb.node("blade"), half).block<3, 3>(0, 0);
    const Mat3 wanted = turn_about(Vec3(1, 2, 3).normalized(), 0.9 * 6.5).toRotationMatrix();
    CHECK((between - wanted).norm() < 0.02);
    ExportScene bare = motion.scene;
    bare.tools = false;
    export_glb(FrameStore(motion.store()), bare, {1, kFrames}, motion.file());
    CHECK(bytes_of(motion.file()).find("\"post\"") == std::string::npos);
}

TEST_CASE("glTF has the looks of a skin, its image within") {
    const Motion motion;
    const Glb glb = motion.written();
    const auto primitives = [&](const char* name) {
        const Json& node = glb.document.at("nodes").at(std::size_t(glb.node(name)));
        return glb.document.at("meshes").at(node.at("mesh").get<std::size_t>()).at("primitives");
    };
    const auto look = [&](const Json& primitive) {
        return glb.document.at("materials").at(primitive.at("material").get<std::size_t>());
    };
    const Json hide = look(primitives("first-1")[0]), cut = look(primitives("first-2")[1]);
    CHECK(hide.at("name") == "hide");
    CHECK(cut.at("name") == "cut");
    CHECK(look(primitives("first-2")[0]) == hide);
    const Json& surface = cut.at("pbrMetallicRoughness");
    CHECK(surface.at("baseColorFactor") == Json({0.5, 0.25, 1.0, 0.25}));
    CHECK(cut.at("alphaMode") == "BLEND");
    CHECK_FALSE(surface.contains("baseColorTexture"));
    REQUIRE(glb.document.at("images").size() == 1);
    const Json& image = glb.document.at("images")[0];
    CHECK(image.at("mimeType") == "image/png");
    CHECK(glb.view(image.at("bufferView")) == "\x89PNG of spots");
    CHECK(hide.at("pbrMetallicRoughness").at("baseColorTexture").at("index") == 0);
    // Places in it count downward.
    const Json attributes = primitives("first-1")[0].at("attributes");
    const std::vector<float> uv = glb.numbers(attributes.at("TEXCOORD_0"));
    const std::vector<std::uint32_t> index = glb.indices(primitives("first-1")[0].at("indices"));
    CHECK(uv.at(2 * index[0]) == 0.5f);
    CHECK(uv.at(2 * index[0] + 1) == 1);
    CHECK(uv.at(2 * index[1] + 1) == 0.75f);
    // Colours of vertices multiply that of the material.
    CHECK_FALSE(attributes.contains("COLOR_0"));
    const Json box = primitives("second")[0];
    const std::vector<float> color = glb.numbers(box.at("attributes").at("COLOR_0"));
    const std::uint32_t first = glb.indices(box.at("indices"))[0];
    CHECK(color.at(3 * first) == 0.25f);
    CHECK(color.at(3 * first + 1) == 0.125f * float(motion.skin[2].triangle[0][0]));
    CHECK(look(box).at("pbrMetallicRoughness").at("baseColorFactor") == Json({0.8, 0.8, 0.8, 1.0}));
}

TEST_CASE("glTF has y upward, and the camera of the stills") {
    Motion motion;
    motion.scene.render.up = Up::z;
    motion.scene.render.width = 320, motion.scene.render.height = 200;
    const Glb glb = motion.written();
    const Eigen::Matrix4d root = glb.world_from_node(glb.node("two"), 0);
    CHECK((root.block<3, 1>(0, 2) - Vec3::UnitY()).norm() < 1e-6);
    const Json& lens = glb.document.at("cameras")[0].at("perspective");
    CHECK(lens.at("aspectRatio").get<double>() == Approx(1.6));
    CHECK(lens.at("znear").get<double>() > 0);
    CHECK(lens.at("zfar").get<double>() > lens.at("znear").get<double>());
    const FrameStore store(motion.store());
    const Shot shot = shot_of(store, motion.scene.render);
    const View view = shot.camera().at(0);
    const Eigen::Matrix4d camera = glb.world_from_node(glb.node("camera"), 0);  // as drawn
    CHECK((camera.block<3, 1>(0, 3) - view.eye).norm() < 1e-5);
    CHECK((camera.block<3, 3>(0, 0) - view.world_from_view).norm() < 1e-5);
}

TEST_CASE("of one frame glTF is still, and the same frames give the same bytes") {
    const Motion motion;
    const Glb still = motion.written({6, 6});
    CHECK_FALSE(still.document.contains("animations"));
    CHECK(still.corners(still.node("second"), 0, "POSITION", 0).size() == 36);
    const Glb some = motion.written({3, 6});
    CHECK_FALSE(some.is_shown(some.node("first-2"), time_of(2)));
    CHECK(some.is_shown(some.node("first-2"), time_of(3)));
    motion.written();
    const std::string once = bytes_of(motion.file());
    motion.written();  // in its place
    CHECK(bytes_of(motion.file()) == once);
}

TEST_CASE("what is not a .glb of swage is left alone, and a broken image is named") {
    const Motion motion;
    fs::create_directory(motion.file().parent_path());
    std::ofstream(motion.file()) << "glTF of somebody";
    const FrameStore store(motion.store());
    try {
        export_glb(store, motion.scene, {1, kFrames}, motion.file());
        FAIL("written over");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::foreign);
    }
    CHECK(bytes_of(motion.file()) == "glTF of somebody");
    fs::remove(motion.file());
    std::ofstream(motion.scratch.path() / "spots.png") << "BM of spots";  // no PNG any more
    try {
        export_glb(store, motion.scene, {1, kFrames}, motion.file());
        FAIL("written");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::output);
        CHECK(std::string(error.what()).find("spots.png") != std::string::npos);
    }
    CHECK_FALSE(fs::exists(motion.file()));
}
