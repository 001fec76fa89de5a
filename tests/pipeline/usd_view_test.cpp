// SPDX-License-Identifier: GPL-3.0-or-later
// Tools, camera and lamp of a run in USD: where they stand is worked out here from the numbers in
// the file alone, and compared with the motion file and with stills.
#include <cstdlib>
#include <fstream>

#include "base/file_contents.h"
#include "geometry/box_mesh.h"
#include "pipeline/draw.h"
#include "pipeline/usd_export.h"
#include "render/image_read.h"
#include "render/studio.h"
#include "tests/catch.h"
#include "tests/render/drawn.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"
#include "tests/shared/usda.h"

using namespace swage;
using test::bytes_of;
namespace fs = std::filesystem;

namespace {

constexpr int kFrames = 6, kSecond = 4;  // the first frame of the second stage

// A red box that moves and turns, under two machines; the second one has a floor.
struct MovedBar {
    Scratch scratch;
    ExportScene scene{"line", {"bar"}};
    std::vector<StoredFrame> frame;
    TriMesh bar = box_mesh(Vec3(-1, -0.25, -0.5), Vec3(1, 0.25, 0.5));
    TriMesh tool = box_mesh(Vec3(-0.1, -0.2, -0.3), Vec3(0.1, 0.2, 0.3));

    MovedBar() {
        bar.material.resize(1);
        bar.material[0].color = {1, 0, 0};
        bar.triangle_material.assign(bar.triangle.size(), 0);
        TriMesh floor = box_mesh(Vec3(-50, -1, -50), Vec3(50, 0, 50));
        scene.stage = {{"1-bend", kSecond - 1}, {"2-drop", kFrames}};
        scene.render.width = 320;
        scene.render.height = 200;
        scene.render.film = false;
        FrameStoreWriter writer(store());
        writer.add_skin(bar);
        writer.add_machine({{"post", tool, {0.25, 0.5, 0.75}}, {"post", tool, {0.25, 0.5, 0.75}}});
        writer.add_machine({{"blade", tool, {0.75, 0.5, 0.5}, Finish::matt},
                            {"floor", floor, {0.5, 0.5, 0.5}, Finish::endless}});
        for (int f = 1; f <= kFrames; ++f) {
            const Pose pose = {turn_about(Vec3(1, 2, 3).normalized(), 0.9 * f),
                               Vec3(0.3 * f, 1, -0.1 * f)};
            StoredFrame now;
            now.body = {{0, bar.position}};
            for (Vec3& p : now.body[0].position) p = Vec3(turn_about(Vec3::UnitY(), 0.2 * f) * p);
            now.machine = f < kSecond ? 0 : 1;
            now.pose = {pose, {Quat::Identity(), {0, f < kSecond ? 2.0 : -0.5, 0}}};
            writer.add_frame(now);
            frame.push_back(now);
        }
        writer.finish();
    }
    fs::path store() const { return scratch.path() / "motion.bin"; }
    Usda written(const FrameRange& frames = {1, kFrames}) const {
        const fs::path file = scratch.path() / "out" / "x.usda";
        export_usd(FrameStore(store()), scene, frames, file);
        return Usda(bytes_of(file));
    }
};

// Of the prim to what it stands in, by its two operations.
Pose pose_of(const Usda& usd, const std::string& prim, int frame) {
    CHECK(usd.text(prim + ".xformOpOrder") == "[\"xformOp:translate\", \"xformOp:orient\"]");
    const std::vector<float> t = usd.numbers(prim + ".xformOp:translate", frame);
    const std::vector<float> q = usd.numbers(prim + ".xformOp:orient", frame);
    REQUIRE(t.size() == 3);
    REQUIRE(q.size() == 4);
    return {Quat(q[0], q[1], q[2], q[3]).normalized(), {t[0], t[1], t[2]}};
}

double number(const Usda& usd, const std::string& attribute) {
    return std::atof(usd.text(attribute).c_str());
}

// The picture's point, from its upper left corner [pixel].
Vec2 seen_at(const Usda& usd, const Vec3& world, int frame, int width, int height) {
    const std::string camera = "/line/camera";
    const Vec3 p = pose_of(usd, camera, frame).inverse() * world;
    const double focal = number(usd, camera + ".focalLength");
    const double x = focal * p.x() / -p.z() / number(usd, camera + ".horizontalAperture");
    const double y = focal * p.y() / -p.z() / number(usd, camera + ".verticalAperture");
    return {(0.5 + x) * width, (0.5 - y) * height};
}

std::string visibility(const Usda& usd, const std::string& prim, int frame) {
    const std::string& text = usd.text(prim + ".visibility", frame);
    return text.substr(1, text.find('"', 1) - 1);
}

}  // namespace

TEST_CASE("tools in USD stand in every frame where the run had them, each as one mesh") {
    const MovedBar run;
    const Usda usd = run.written();
    const struct {
        std::string prim;
        int part, first, last;
    } expected[] = {{"_1_bend/post", 0, 1, kSecond - 1},
                    {"_1_bend/post_2", 1, 1, kSecond - 1},
                    {"_2_drop/blade", 0, kSecond, kFrames},
                    {"_2_drop/floor", 1, kSecond, kFrames}};
    for (const auto& one : expected) {
        const std::string prim = "/line/machine/" + one.prim;
        INFO(prim);
        REQUIRE(usd.kind(prim) == "Mesh");
        CHECK(usd.times(prim + ".points").empty());
        CHECK(usd.numbers(prim + ".faceVertexCounts", 1) == std::vector<float>(12, 3));
        for (int f = one.first; f <= one.last; ++f) {
            const Pose exact = run.frame[std::size_t(f) - 1].pose[std::size_t(one.part)];
            const Pose told = pose_of(usd, prim, f);
            for (const Vec3& p : run.tool.position) {
                CHECK((told * p - exact * p).norm() < 1e-6);
            }
        }
        // Neighbouring turns are told alike, so that a reader goes the shorter way between them.
        for (int f = one.first + 1; f <= one.last; ++f) {
            const auto before = usd.numbers(prim + ".xformOp:orient", f - 1);
            const auto now = usd.numbers(prim + ".xformOp:orient", f);
            float dot = 0;
            for (int k = 0; k < 4; ++k) dot += before[std::size_t(k)] * now[std::size_t(k)];
            CHECK(dot >= 0);
        }
    }
    std::vector<float> places;
    for (const Vec3& p : run.tool.position) {
        for (int k = 0; k < 3; ++k) places.push_back(static_cast<float>(p[k]));
    }
    CHECK(usd.numbers("/line/machine/_1_bend/post.points", 1) == places);
    CHECK(bytes_of(run.scratch.path() / "out/x.usda").find("string name = \"1-bend\"") !=
          std::string::npos);
}

TEST_CASE("tools in USD are to be seen as long as their stage lasts, in their colour") {
    const MovedBar run;
    const Usda usd = run.written();
    for (int f = 1; f <= kFrames; ++f) {
        INFO(f);
        CHECK(visibility(usd, "/line/machine/_1_bend", f) ==
              (f < kSecond ? "inherited" : "invisible"));
        CHECK(visibility(usd, "/line/machine/_2_drop", f) ==
              (f < kSecond ? "invisible" : "inherited"));
    }
    const std::string looks = "/line/materials/";
    CHECK(usd.text("/line/machine/_1_bend/post.material:binding") == "<" + looks + "post>");
    CHECK(usd.text("/line/machine/_1_bend/post_2.material:binding") == "<" + looks + "post>");
    CHECK(usd.text(looks + "post/surface.inputs:diffuseColor") == "(0.25, 0.5, 0.75)");
    CHECK(number(usd, looks + "post/surface.inputs:metallic") == Approx(1));
    CHECK(number(usd, looks + "blade/surface.inputs:metallic") == 0);
    CHECK(usd.numbers("/line/machine/_1_bend/post.primvars:displayColor", 1) ==
          std::vector<float>{0.25f, 0.5f, 0.75f});
    // Of a part of the frames those that are in it, and what is there all along says nothing.
    const Usda first = run.written({1, kSecond - 1});
    CHECK(first.kind("/line/machine/_2_drop").empty());
    CHECK_FALSE(first.has("/line/machine/_1_bend.visibility"));
}

TEST_CASE("USD has the tools that stills show, and none where they are not wanted") {
    MovedBar run;
    run.scene.render.ground = false;  // for which the floor stands
    CHECK(run.written().kind("/line/machine/_2_drop/floor").empty());
    CHECK(run.written().kind("/line/machine/_2_drop/blade") == "Mesh");
    const Usda with = run.written();
    run.scene.tools = false;
    CHECK(run.written().kind("/line/machine").empty());
    // What the camera frames is what the stills frame all the same.
    CHECK(run.written().numbers("/line/camera.xformOp:translate", 1) ==
          with.numbers("/line/camera.xformOp:translate", 1));
    run.scene.tools = true;
    run.scene.render.hide = {"blade"};
    CHECK(run.written().kind("/line/machine/_2_drop/blade").empty());
    run.scene.render.tools = false;
    CHECK(run.written().kind("/line/machine").empty());
}

TEST_CASE("the camera in USD sees a body where stills show it") {
    if (!can_draw()) return;
    MovedBar run;
    RenderSettings& render = run.scene.render;
    render.ground = render.tools = false;
    const int look = GENERATE(0, 1, 2, 3, 4, 5);
    if (look == 0) {  // a flight round the body, in a picture that is higher than wide
        std::swap(render.width, render.height);
        render.field_of_view = 0.9;
        render.camera.resize(2);
        render.camera[1].at = 1;
        render.camera[1].azimuth = 2.5;
        render.camera[1].zoom = 0.7;
    }
    if (look == 1) render.up = Up::z;
    if (look == 2) render.up = Up::x;
    if (look == 4) render.up = Up::minus_y;
    if (look == 5) render.up = Up::minus_z;
    if (look == 3) {
        render.up = Up::z;
        CameraKey key;
        key.eye = Vec3(3, -4, 2.5);
        key.target = Vec3(0.2, 0.1, 0);
        render.camera = {key};
    }
    const Usda usd = run.written();
    Stopwatch watch;
    const DrawnFiles files{run.scratch.path() / "drawn"};
    draw_run(FrameStore(run.store()), render, {1, kFrames}, files, watch);
    for (int f = 1; f <= kFrames; ++f) {
        INFO(look << ", " << f);
        const Image image = read_image(files.still(f), 1000);
        REQUIRE(image.width == render.width);
        Vec2 low(1e9, 1e9), high(-1e9, -1e9), told_low = low, told_high = high;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const std::uint8_t* rgb = image.pixel(x, y);
                if (rgb[0] < 1.5 * rgb[1]) continue;
                low = low.cwiseMin(Vec2(x, y));
                high = high.cwiseMax(Vec2(x + 1, y + 1));
            }
        }
        const std::vector<float> place = usd.numbers("/line/bar.points", f);
        for (std::size_t i = 0; i < place.size(); i += 3) {
            const Vec2 at =
                seen_at(usd, {place[i], place[i + 1], place[i + 2]}, f, image.width, image.height);
            told_low = told_low.cwiseMin(at);
            told_high = told_high.cwiseMax(at);
        }
        CHECK((told_low - low).cwiseAbs().maxCoeff() < 1);
        CHECK((told_high - high).cwiseAbs().maxCoeff() < 1);
        CHECK((high - low).minCoeff() > 30);
        CHECK(low.minCoeff() > 0);  // all of it is seen
        CHECK((high - Vec2(image.width, image.height)).maxCoeff() < 0);
    }
}

TEST_CASE("the camera in USD shows all between its clipping planes, and stays where it does") {
    MovedBar run;
    const Usda usd = run.written();
    const std::vector<float> range = usd.numbers("/line/camera.clippingRange", 1);
    REQUIRE(range.size() == 2);
    CHECK(range[0] > 0);
    for (int f = 1; f <= kFrames; ++f) {
        const Pose pose = pose_of(usd, "/line/camera", f);
        std::vector<Vec3> places = run.frame[std::size_t(f) - 1].body[0].position;
        for (const Vec3& p : run.tool.position) {
            places.push_back(run.frame[std::size_t(f) - 1].pose[0] * p);
        }
        for (const Vec3& world : places) {
            const double depth = -(pose.inverse() * world).z();
            CHECK(depth > range[0]);
            CHECK(depth < range[1]);
        }
    }
    CHECK(usd.times("/line/camera.xformOp:translate").empty());
    CHECK(usd.text("/line/camera.projection") == "\"perspective\"");
}

TEST_CASE("the lamp in USD shines from where the one of the stills does") {
    MovedBar run;
    RenderSettings& render = run.scene.render;
    render.up = GENERATE(Up::y, Up::z);
    render.light = {0, 0.7};  // above the camera
    const Usda usd = run.written();
    const Vec3 up = render.up == Up::z ? Vec3::UnitZ() : Vec3::UnitY();
    const Vec3 from = pose_of(usd, "/line/key_lamp", 1).turn(Vec3::UnitZ());
    const Vec3 back = pose_of(usd, "/line/camera", 1).turn(Vec3::UnitZ());
    CHECK(from.dot(up) == Approx(std::sin(0.7)));
    const Vec3 level = from - from.dot(up) * up, seen = back - back.dot(up) * up;
    CHECK(level.normalized().dot(seen.normalized()) == Approx(1));
    CHECK(usd.kind("/line/key_lamp") == "DistantLight");
    CHECK(number(usd, "/line/key_lamp.inputs:angle") == Approx(13.69).margin(0.01));
    const std::string shader = bytes_of(fs::path(SWAGE_SOURCE_DIR) / "shaders/light.glsl");
    CHECK(shader.find(fmt::format("KEY = vec3({}, {}, {});", kKeyLight[0], kKeyLight[1],
                                  kKeyLight[2])) != std::string::npos);
}
