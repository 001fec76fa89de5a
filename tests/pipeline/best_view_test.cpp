// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/best_view.h"

#include "geometry/box_mesh.h"
#include "pipeline/draw.h"
#include "pipeline/render_record.h"
#include "pipeline/shot.h"
#include "pipeline/usd_export.h"
#include "tests/catch.h"
#include "tests/render/drawn.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"
#include "tests/shared/usda.h"

using namespace swage;
using test::bytes_of;
namespace fs = std::filesystem;

namespace {

constexpr double kDegree = kPi / 180;

// A box that stays where it is, and a tool at two places in turn.
struct Film {
    Scratch scratch;

    Film(const TriMesh& work_piece, const TriMesh& tool, const Vec3& first, const Vec3& last,
         Finish finish = Finish::metal) {
        FrameStoreWriter writer(file());
        writer.add_skin(work_piece);
        writer.add_machine({{"tool", tool, {0.5, 0.5, 0.5}, finish}});
        for (int f = 0; f < 5; ++f) {
            const Vec3 at = first + 0.25 * f * (last - first);
            writer.add_frame({{{0, work_piece.position}}, 0, {{Quat::Identity(), at}}});
        }
        writer.finish();
    }
    fs::path file() const { return scratch.path() / "motion.bin"; }
    Shot shot(const RenderSettings& settings) const {
        return shot_of(FrameStore(file()), settings);
    }
};

const TriMesh kBox = box_mesh(Vec3(-1, 0, -1), Vec3(1, 1, 1));

// A plate twice as wide as the box, which comes down on it.
Film pressed_box() {
    return {kBox, box_mesh(Vec3(-2, 0, -2), Vec3(2, 0.3, 2)), {0, 1.4, 0}, {0, 1, 0}};
}

RenderSettings open_settings(bool azimuth = true, bool elevation = true) {
    RenderSettings settings;
    settings.open = {azimuth, elevation};
    return settings;
}

CameraKey chosen_for(const Film& film, const RenderSettings& settings) {
    return film.shot(settings).settings.camera.front();
}

}  // namespace

TEST_CASE("under a plate that hides a box the camera goes down") {
    const Film film = pressed_box();
    const Shot shot = film.shot(open_settings());
    const CameraKey usual, &key = shot.settings.camera.front();
    CHECK(key.elevation < 11 * kDegree);
    CHECK(key.azimuth == usual.azimuth);
    REQUIRE(shot.chosen);
    CHECK(shot.chosen->seen_before < 0.6);
    CHECK(shot.chosen->seen > shot.chosen->seen_before + 0.15);
}

TEST_CASE("a tool that is not drawn hides nothing") {
    RenderSettings settings = open_settings();
    settings.hide = {"tool"};
    CHECK(chosen_for(pressed_box(), settings).elevation == CameraKey().elevation);
}

TEST_CASE("tools that hide more than half of a box from everywhere are named") {
    const TriMesh hood = box_mesh(Vec3(-3, -3, -3), Vec3(3, 3, 3));
    const Film film(kBox, hood, Vec3::Zero(), Vec3::Zero());
    const Shot shot = film.shot(open_settings());
    REQUIRE(shot.chosen);
    CHECK(shot.chosen->seen == 0);
    CHECK(shot.chosen->hiding == std::vector<std::string>{"tool"});
    CHECK(pressed_box().shot(open_settings()).chosen->hiding.empty());
}

TEST_CASE("where a wall hides a box the camera goes round it") {
    // As high as the box, on the side of the usual view.
    const TriMesh wall = box_mesh(Vec3(-2, 0, -0.1), Vec3(2, 1.4, 0.1));
    const Film film(kBox, wall, {0, 0, 1.3}, {0, 0, 1.2});
    const CameraKey usual, key = chosen_for(film, open_settings());
    CHECK(std::cos(key.azimuth) < 0.5);
    // What is given is kept, whichever of the two.
    CHECK(chosen_for(film, open_settings(false, true)).azimuth == usual.azimuth);
    RenderSettings high = open_settings(true, false);
    high.camera[0].elevation = 15 * kDegree;
    const CameraKey kept = chosen_for(film, high);
    CHECK(kept.elevation == 15 * kDegree);
    CHECK(std::cos(kept.azimuth) < 0.5);
}

TEST_CASE("the camera stays where it is when its angles are given, or nothing hides the bodies") {
    const CameraKey usual;
    const auto stays = [&](const Film& film, const RenderSettings& settings) {
        const CameraKey key = chosen_for(film, settings);
        return key.azimuth == usual.azimuth && key.elevation == usual.elevation;
    };
    const Film hidden = pressed_box();
    CHECK_FALSE(stays(hidden, open_settings()));
    CHECK(stays(hidden, open_settings(false, false)));
    RenderSettings alone = open_settings();
    alone.tools = false;
    CHECK(stays(hidden, alone));
    // Long, so that it looks larger from another side; under it, and beside it in the backdrop.
    const TriMesh bar = box_mesh(Vec3(-0.3, 0, -4), Vec3(0.3, 0.5, 4));
    const TriMesh block = box_mesh(Vec3(-2, -1, -5), Vec3(0.5, 0, 5));
    CHECK(stays(Film(bar, block, Vec3::Zero(), Vec3::Zero()), open_settings()));
    CHECK(stays(Film(bar, block, {-3, 1, 0}, {-3, 1, 0}), open_settings()));
    // A floor without end that is drawn only with the ground.
    const Film roofed(kBox, box_mesh(Vec3(-2, 0, -2), Vec3(2, 0.3, 2)), {0, 1.4, 0}, {0, 1, 0},
                      Finish::endless);
    CHECK_FALSE(stays(roofed, open_settings()));
    alone = open_settings();
    alone.ground = false;
    CHECK(stays(roofed, alone));
}

TEST_CASE("a sheet is not shown from its edge because a tool over it hides less from there") {
    const TriMesh sheet = box_mesh(Vec3(-1, 0, -1), Vec3(1, 0.01, 1));
    const TriMesh cover = box_mesh(Vec3(-2, 0, 0), Vec3(2, 0.1, 1));
    const Film film(sheet, cover, {0, 0.5, 0.3}, {0, 0.5, 0.3});
    RenderSettings settings = open_settings(false, true);
    settings.camera[0].azimuth = 0;
    const Shot shot = film.shot(settings);
    CHECK(shot.chosen->seen_before < 0.8);
    CHECK(shot.settings.camera.front().elevation == CameraKey().elevation);
}

TEST_CASE("slices that stand one behind the other are not shown along their row") {
    // From there no tool hides any of their faces, but all but the first hide each other.
    TriMesh slices;
    for (int n = -3; n <= 3; ++n) {
        const TriMesh one = box_mesh(Vec3(n - 0.1, -1, -1), Vec3(n + 0.1, 1, 1));
        const int before = static_cast<int>(slices.position.size());
        slices.position.insert(slices.position.end(), one.position.begin(), one.position.end());
        for (const Corners& t : one.triangle) {
            slices.triangle.push_back({t[0] + before, t[1] + before, t[2] + before});
        }
    }
    // A screen that stands before the camera at first, and then goes up.
    const TriMesh screen = box_mesh(Vec3(-3, -3, 2.5), Vec3(12, 8, 2.6));
    const Film film(slices, screen, Vec3::Zero(), {0, 20, 0});
    const double azimuth = chosen_for(film, open_settings(true, false)).azimuth;
    CAPTURE(azimuth / kDegree);
    CHECK(std::abs(std::sin(azimuth)) < 0.95);  // 1: along them
}

TEST_CASE("a run has one view, whatever the size, lens and zoom of its pictures and their up") {
    const Film film = pressed_box();
    const CameraKey usual = chosen_for(film, open_settings());
    RenderSettings other = open_settings();
    other.width = 300;
    other.height = 900;
    other.field_of_view = 1.2;
    other.camera[0].zoom = 3;
    other.camera[0].target = Vec3(0, 1, 0);
    const CameraKey key = chosen_for(film, other);
    CHECK(key.azimuth == usual.azimuth);
    CHECK(key.elevation == usual.elevation);
    CHECK(key.zoom == 3);
    CHECK(key.target == other.camera[0].target);
    // Turned as a whole it is the same film.
    const Quat turn = drawn_from_up(Up::z).conjugate();
    TriMesh box = kBox, plate = box_mesh(Vec3(-2, 0, -2), Vec3(2, 0.3, 2));
    for (TriMesh* mesh : {&box, &plate}) {
        for (Vec3& p : mesh->position) p = turn * p;
    }
    const Film turned(box, plate, turn * Vec3(0, 1.4, 0), turn * Vec3(0, 1, 0));
    RenderSettings up = open_settings();
    up.up = Up::z;
    CHECK(chosen_for(turned, up).elevation == usual.elevation);
}

TEST_CASE("an orbit is lowered as a whole, and goes on as far as it was to") {
    RenderSettings settings = open_settings();
    settings.camera.resize(2);
    settings.camera[1].at = 1;
    settings.camera[1].azimuth += 2 * kPi;
    const Shot shot = pressed_box().shot(settings);
    const auto& keys = shot.settings.camera;
    REQUIRE(keys.size() == 2);
    CHECK(keys[0].elevation < 11 * kDegree);
    CHECK(keys[1].elevation == keys[0].elevation);
    CHECK(comes_round(keys));
}

TEST_CASE("stills and export look from where the camera that is left open goes") {
    const Film film = pressed_box();
    RenderSettings open = open_settings();
    open.width = 160;
    open.height = 90;
    open.film = false;
    // A record keeps what was open.
    RenderSettings told = render_settings_of({{"render", render_json(open)}});
    CHECK(told.open.azimuth);
    CHECK(told.open.elevation);
    RenderSettings given = open;
    given.open = {};
    CHECK_FALSE(render_settings_of({{"render", render_json(given)}}).open.any());
    const auto camera_in_usd = [&](const RenderSettings& settings) {
        const fs::path file = film.scratch.path() / "x.usda";
        export_usd(FrameStore(film.file()),
                   {.name = "x", .body = {"box"}, .render = settings, .stage = {{"1-press", 5}}},
                   {1, 5}, file);
        const Usda usd(bytes_of(file));
        return std::pair(usd.numbers("/x/camera.xformOp:translate", 1),
                         usd.numbers("/x/camera.xformOp:orient", 1));
    };
    const auto high = camera_in_usd(given);
    given.camera = film.shot(open).settings.camera;
    CHECK(camera_in_usd(told) == camera_in_usd(given));
    CHECK(camera_in_usd(told) != high);
    if (!can_draw()) return;
    const auto still = [&](const RenderSettings& settings) {
        Stopwatch watch;
        const DrawnFiles files{film.scratch.path() / "drawn"};
        draw_run(FrameStore(film.file()), settings, {3, 3}, files, watch);
        return bytes_of(files.still(3));
    };
    CHECK(still(told) == still(given));
    given.camera = {CameraKey()};
    CHECK(still(told) != still(given));
}
