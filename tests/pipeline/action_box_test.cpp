// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/action_box.h"

#include <cmath>

#include "geometry/box_mesh.h"
#include "render/camera.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

namespace {

// A cube of 1 m and, broken off it or beside it from the start, one of `size` that lies `away`.
ActionBox action_of(double size, double away, bool broken_off,
                    const std::vector<DrawnPart>& machine = {},
                    const RenderSettings& settings = {}) {
    const TriMesh cube = box_mesh(Vec3::Zero(), Vec3::Ones());
    TriMesh both = cube;
    for (const Vec3& p : cube.position) both.position.push_back(size * p);
    for (const Corners& c : cube.triangle) both.triangle.push_back({c[0] + 8, c[1] + 8, c[2] + 8});
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion";
    FrameStoreWriter writer(file);
    writer.add_skin(cube);
    writer.add_skin(both);
    const auto frame = [&](int skin, double at) {
        StoredFrame stored;
        stored.pose.resize(machine.size());
        stored.body.push_back({skin, {}});
        for (std::size_t v = 0; v < (skin == 0 ? 8u : 16u); ++v) {
            const Vec3 p = both.position[v] + (v < 8 ? Vec3(0, 0, 0) : Vec3(at, -0.1 * at, 0));
            stored.body[0].position.push_back(p);
        }
        return stored;
    };
    writer.add_machine(machine);
    writer.add_frame(frame(broken_off ? 0 : 1, 1));
    writer.add_frame(frame(1, away));
    writer.finish();
    return find_action(FrameStore(file), settings, Quat::Identity());
}

}  // namespace

TEST_CASE("a chip that flies off does not make the picture small; a part that goes does") {
    const ActionBox chip = action_of(0.1, 50, true);
    CHECK(chip.bounds.high.x() == 1);
    CHECK(chip.ground_height == 0);
    CHECK(action_of(0.3, 50, true).bounds.high.x() == Approx(50.3));
    // Near by it is shown, and so is what the mesh came with.
    CHECK(action_of(0.1, 1, true).bounds.high.x() == Approx(1.1));
    CHECK(action_of(0.1, 50, false).bounds.high.x() == Approx(50.1));
}

TEST_CASE("the picture shows where tools are, but no end of what is endless") {
    DrawnPart slab;
    slab.surface = box_mesh(Vec3(-5, -0.1, -5), Vec3(5, 0, 5));
    slab.name = "slab";
    const auto widest = [&](Finish finish, const std::vector<std::string>& hide = {}) {
        slab.finish = finish;
        RenderSettings settings;
        settings.hide = hide;
        double most = 0;
        for (const Vec3& p : action_of(1, 2, false, {slab}, settings).framed.outline)
            most = std::max(most, p.z());
        return most;
    };
    CHECK(widest(Finish::metal) > 1.1);
    CHECK(widest(Finish::endless) == Approx(1));
    // What is not drawn takes no room.
    CHECK(widest(Finish::metal, {"post", "slab"}) == Approx(1));
    CHECK(widest(Finish::metal, {"post"}) > 1.1);
}

TEST_CASE("tools that reach a little lower than the work-piece stand on the ground, not in it") {
    DrawnPart post;
    post.surface = box_mesh(Vec3(0, -0.8, 0), Vec3(0.1, 1.2, 0.1));
    CHECK(action_of(1, 2, false, {post}).ground_height == Approx(-0.8));
    post.surface = box_mesh(Vec3(0, -80, 0), Vec3(0.1, 1.2, 0.1));
    CHECK(action_of(1, 2, false, {post}).ground_height > -3);
}

TEST_CASE("a camera that goes along frames the bodies as large as they are, and does not jerk") {
    // A cube of 1 m falls by 20 m, beside a post that stands, and comes to rest at once.
    constexpr int kFrames = 61;
    constexpr double kFall = 20;
    const TriMesh cube = box_mesh(Vec3::Zero(), Vec3::Ones());
    const auto height = [](int f) { return kFall * (1 - std::min(1.0, f * f / 1600.0)); };
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion";
    FrameStoreWriter writer(file);
    writer.add_skin(cube);
    DrawnPart post;
    post.surface = box_mesh(Vec3(2, 0, 0), Vec3(2.1, 40, 0.1));
    writer.add_machine({post});
    for (int f = 0; f < kFrames; ++f) {
        StoredFrame stored;
        stored.pose.resize(1);
        stored.body.push_back({0, cube.position});
        for (Vec3& p : stored.body[0].position) p.y() += height(f);
        writer.add_frame(stored);
    }
    writer.finish();
    const FrameStore store(file);
    const ActionBox stays = find_action(store, {}, Quat::Identity());
    const ActionBox goes = find_action(store, {}, Quat::Identity(), 4);
    CHECK(stays.framed.way.empty());
    CHECK(goes.bounds.low == stays.bounds.low);
    CHECK(goes.bounds.high == stays.bounds.high);
    CHECK(goes.ground_height == stays.ground_height);
    REQUIRE(goes.framed.way.size() == kFrames);
    CHECK(goes.framed.bounds.size().y() < 6);
    RenderSettings settings;
    settings.width = settings.height = 400;
    const Lens lens = lens_of(settings);
    const CameraPath path(settings, goes.framed);
    double largest = 0;
    for (int f = 0; f < kFrames; ++f) {
        const View view = path.at(still_share(settings.camera, f, kFrames));
        for (const Vec3& corner : cube.position) {
            const Vec3 p = view.in_view(corner + height(f) * Vec3::UnitY());
            REQUIRE(p.z() < 0);
            const double reach =
                std::max(std::abs(p.x()) / lens.tangent_x, std::abs(p.y()) / lens.tangent_y) /
                -p.z();
            CHECK(reach < 1);
            largest = std::max(largest, reach);
        }
    }
    CHECK(largest > 0.5);
    // A body that stops at once from 0.98 m a frame takes the camera's speed over several.
    const auto speed = [&](int f) { return (goes.framed.way[f + 1] - goes.framed.way[f]).norm(); };
    for (int f = 0; f + 2 < kFrames; ++f) CHECK(std::abs(speed(f + 1) - speed(f)) < 0.15);
    // What is at rest as the film begins takes it along by its mean speed in the first frames.
    CHECK(std::abs(speed(1) - speed(0)) < 0.005);
    CHECK(speed(0) < 0.1);
    CHECK((goes.framed.way[0] - Vec3(0.5, kFall + 0.5, 0.5)).norm() < 1e-12);
    CHECK((goes.framed.way[kFrames - 1] - Vec3(0.5, 0.5, 0.5)).norm() < 1e-12);
}

TEST_CASE("a camera goes along with what flies evenly from the first still to the last") {
    const TriMesh cube = box_mesh(Vec3::Zero(), Vec3::Ones());
    const Vec3 speed(0.9, -0.2, 0.3);  // [m/frame]
    for (const int frames : {1, 2, 5, 7, 10, 20, 60, 100}) {
        INFO(frames);
        const Scratch scratch;
        const fs::path file = scratch.path() / "motion";
        FrameStoreWriter writer(file);
        writer.add_skin(cube);
        writer.add_machine({});
        for (int f = 0; f < frames; ++f) {
            StoredFrame stored;
            stored.body.push_back({0, cube.position});
            for (Vec3& p : stored.body[0].position) p += f * speed;
            writer.add_frame(stored);
        }
        writer.finish();
        const FrameStore store(file);
        for (const double calm : {0.4, 3.75, 9.0, 40.0}) {
            INFO(calm);
            const ActionBox goes = find_action(store, {}, Quat::Identity(), calm);
            REQUIRE(goes.framed.way.size() == static_cast<std::size_t>(frames));
            double off = 0;
            for (int f = 0; f < frames; ++f) {
                const Vec3 middle = Vec3::Constant(0.5) + f * speed;
                off = std::max(off, (goes.framed.way[f] - middle).norm());
            }
            CHECK(off < 1e-4);
            CHECK(goes.framed.bounds.size().maxCoeff() < 1.001);
        }
    }
}
