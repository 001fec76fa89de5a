// SPDX-License-Identifier: GPL-3.0-or-later
// Passes as files: what mattes.json says is what the mattes show.
#include "pipeline/passes.h"

#include <set>

#include "geometry/box_mesh.h"
#include "pipeline/draw.h"
#include "pipeline/render_directory.h"
#include "pipeline/shot.h"
#include "render/exr.h"
#include "render/image_read.h"
#include "tests/catch.h"
#include "tests/render/drawn.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/json.h"
#include "tests/shared/meshes.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

namespace {

constexpr int kFrames = 4, kSecond = 3;  // the first frame of the second stage

// Two bodies side by side, under a post and then a blade.
struct TwoStages {
    Scratch scratch;
    RunNames names{{"left", "right"}, {{"1-bend", kSecond - 1}, {"2-cut", kFrames}}};
    RenderSettings settings;

    TwoStages() {
        settings.width = 160;
        settings.height = 90;
        settings.film = false;
        settings.passes = {PicturePass::matte, PicturePass::depth};
        const TriMesh box = box_mesh(Vec3::Constant(-0.5), Vec3::Constant(0.5));
        FrameStoreWriter writer(store());
        writer.add_skin(box);
        writer.add_machine({{"post", box}});
        writer.add_machine({{"blade", box}});
        for (int f = 1; f <= kFrames; ++f) {
            StoredFrame now;
            now.body.assign(2, {0, box.position});
            for (Vec3& p : now.body[0].position) p.x() -= 1 + 0.1 * f;
            for (Vec3& p : now.body[1].position) p.x() += 1;
            now.machine = f < kSecond ? 0 : 1;
            now.pose = {{Quat::Identity(), {0, 1.5, 0}}};
            writer.add_frame(now);
        }
        writer.finish();
    }
    fs::path store() const { return scratch.path() / "motion.bin"; }
    fs::path out() const { return scratch.path() / "drawn"; }
    DrawnFiles files() const { return {out()}; }
    void draw(const FrameRange& frames = {1, kFrames}) const {
        Stopwatch watch;
        draw_run(FrameStore(store()), settings, frames, files(), watch, names);
    }
};

using Color = std::array<int, 3>;

}  // namespace

TEST_CASE("colours of mattes are all different, and nothing is black") {
    const std::vector<MatteColor> colors = matte_colors(20'000);  // of what has gone to crumbs
    CHECK(colors[0] == MatteColor{0, 0, 0});
    CHECK(std::set<MatteColor>(colors.begin(), colors.end()).size() == colors.size());
    // What a number has does not go by how many there are.
    CHECK(matte_colors(7)[6] == colors[6]);
}

TEST_CASE("every pixel of a matte is of one of those that its table names") {
    if (!can_draw()) return;
    const TwoStages run;
    run.draw();
    const Json table =
        parse_json(test::bytes_of(run.files().table(PicturePass::matte))).at("mattes");
    std::map<Color, std::string> name;
    for (const Json& one : table) {
        const std::string of_stage =
            one.contains("stage") ? one.at("stage").get<std::string>() : "";
        CHECK(name.emplace(one.at("color").get<Color>(),
                           of_stage + "/" + one.at("name").get<std::string>())
                  .second);
    }
    for (int f = 1; f <= kFrames; ++f) {
        const Image matte = read_image(run.files().pass(f, PicturePass::matte));
        std::map<std::string, int> count;
        for (int y = 0; y < matte.height; ++y) {
            for (int x = 0; x < matte.width; ++x) {
                const std::uint8_t* p = matte.pixel(x, y);
                const auto known = name.find({p[0], p[1], p[2]});
                REQUIRE(known != name.end());
                ++count[known->second];
            }
        }
        const std::string tool = f < kSecond ? "1-bend/post" : "2-cut/blade";
        for (const std::string& seen : {std::string("/left"), std::string("/right"), tool}) {
            INFO(f << seen);
            CHECK(count[seen] > 150);
        }
        CHECK(count["/ground"] > 1000);
        CHECK(count[f < kSecond ? "2-cut/blade" : "1-bend/post"] == 0);
        CHECK(fs::file_size(run.files().pass(f, PicturePass::depth)) > 1000);
        CHECK_FALSE(fs::exists(run.files().pass(f, PicturePass::normal)));
    }
}

TEST_CASE("passes change no still, and go when others are drawn in their place") {
    if (!can_draw()) return;
    TwoStages run;
    const auto draw = [&](const FrameRange& frames) {
        const RenderDirectory directory(run.out(), false, 1);
        run.draw(frames);
        return directory.remove_others(frames, false, run.settings.passes);
    };
    draw({1, 3});
    const std::string still = test::bytes_of(run.files().still(2));
    const std::string matte = test::bytes_of(run.files().pass(2, PicturePass::matte));
    run.settings.passes = {PicturePass::normal, PicturePass::matte};
    CHECK(draw({2, 3}) == 5);  // a still with two, and two depths
    CHECK(fs::exists(run.files().pass(2, PicturePass::normal)));
    CHECK_FALSE(fs::exists(run.files().pass(2, PicturePass::depth)));
    CHECK_FALSE(fs::exists(run.files().pass(1, PicturePass::matte)));
    CHECK(test::bytes_of(run.files().pass(2, PicturePass::matte)) == matte);
    run.settings.passes.clear();
    CHECK(draw({2, 2}) == 6);  // a still, four passes and their table
    CHECK(test::bytes_of(run.files().still(2)) == still);
    CHECK_FALSE(fs::exists(run.files().table(PicturePass::matte)));
}

TEST_CASE(
    "a piece that comes off has a colour of its own from then on, and its body's until then") {
    if (!can_draw()) return;
    TwoStages run;
    run.settings.passes = {PicturePass::piece, PicturePass::matte};
    const auto halves = [](double apart) {
        return test::together(box_mesh(Vec3(-0.5 - apart, 0, -0.5), Vec3(-apart, 1, 0.5)),
                              box_mesh(Vec3(apart, 0, -0.5), Vec3(0.4 + apart, 1, 0.5)));
    };
    {
        FrameStoreWriter writer(run.store());
        const TriMesh whole = box_mesh(Vec3(-0.5, 0, -0.5), Vec3(0.4, 1, 0.5));
        writer.add_skin(whole);
        writer.add_skin(halves(0));
        writer.add_machine({});
        for (int f = 1; f <= kFrames; ++f) {
            StoredFrame now;
            now.body = {{f < kSecond ? 0 : 1,
                         f < kSecond ? whole.position : halves(0.2 * (f - 2)).position}};
            writer.add_frame(now);
        }
        writer.finish();
    }
    run.draw();
    const Json pieces =
        parse_json(test::bytes_of(run.files().table(PicturePass::piece))).at("pieces");
    std::vector<Color> color;
    for (const Json& one : pieces) {
        if (one.at("is") != "piece") continue;
        CHECK(one.at("name") == "left");
        CHECK(one.at("piece") == color.size() + 1);
        CHECK(one.at("from_frame") == (color.empty() ? 1 : kSecond));
        color.push_back(one.at("color").get<Color>());
    }
    REQUIRE(color.size() == 2);
    for (int f = 1; f <= kFrames; ++f) {
        const Image piece = read_image(run.files().pass(f, PicturePass::piece));
        const Image matte = read_image(run.files().pass(f, PicturePass::matte));
        std::array<int, 2> seen{};
        int is_body = 0;
        for (std::size_t i = 0; i < piece.rgb.size(); i += 3) {
            const Color here = {piece.rgb[i], piece.rgb[i + 1], piece.rgb[i + 2]};
            const Color whose = {matte.rgb[i], matte.rgb[i + 1], matte.rgb[i + 2]};
            for (std::size_t p = 0; p < 2; ++p) seen[p] += here == color[p];
            is_body += whose == color[0];
        }
        INFO(f);
        CHECK(seen[0] > 300);
        CHECK((seen[1] > 300) == (f >= kSecond));
        CHECK(seen[0] + seen[1] == is_body);
        if (f < kSecond) CHECK(piece.rgb == matte.rgb);
    }
    // The frame that a piece comes in is called what its still is called.
    const DrawnFiles late{run.out(), 1001};
    run.settings.first_frame = 1001;
    Stopwatch watch;
    draw_run(FrameStore(run.store()), run.settings, {1, 1}, late, watch, run.names);
    const Json then = parse_json(test::bytes_of(late.table(PicturePass::piece))).at("pieces");
    std::vector<int> from;
    for (const Json& one : then) {
        if (one.at("is") == "piece") from.push_back(one.at("from_frame"));
    }
    CHECK(from == std::vector<int>{1001, 1000 + kSecond});
}

TEST_CASE("frames are called from the first one's number on, and so are their passes") {
    if (!can_draw()) return;
    TwoStages run;
    run.settings.first_frame = 998;
    const DrawnFiles files{run.out(), 998};
    Stopwatch watch;
    draw_run(FrameStore(run.store()), run.settings, {2, kFrames}, files, watch, run.names);
    CHECK(files.still(2).filename() == "frame_0999.png");
    CHECK(files.pass(4, PicturePass::depth).filename() == "frame_1001.depth.exr");
    for (int f = 2; f <= kFrames; ++f) CHECK(fs::exists(files.still(f)));
    // What is drawn under other numbers next takes their place.
    const RenderDirectory directory(run.out(), true, 1);
    run.settings.first_frame = 1;
    run.draw({1, 1});
    CHECK(directory.remove_others({1, 1}, false, run.settings.passes) == 9);
    CHECK_FALSE(fs::exists(files.still(2)));
    CHECK(fs::exists(run.files().still(1)));
}

TEST_CASE("passes of floats hold what was drawn, by its names, and normals as in the world") {
    TwoStages run;
    run.settings.passes = {PicturePass::normal, PicturePass::motion, PicturePass::beauty};
    const Quat drawn_from_world = drawn_from_up(GENERATE(Up::y, Up::z, Up::x, Up::minus_x));
    const FrameStore store(run.store());
    const DrawnFiles files = run.files();
    fs::create_directories(files.still(1).parent_path());
    PassWriter writer(store, run.settings, files, run.names, drawn_from_world);
    PassPicture picture;
    Layers& layers = picture.layers;
    layers.width = 3, layers.height = 1;
    layers.depth.assign(3, 1.0f), layers.item.assign(3, kGroundThere);
    const std::vector<Vec3> world = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    for (const Vec3& one : world) {
        const Eigen::Vector3f drawn = (drawn_from_world * one).cast<float>();
        layers.normal.push_back(drawn.array().round());
        picture.motion.emplace_back(1, 2, 3, 4);
        layers.beauty.insert(layers.beauty.end(), {0.125f, 0.25f, 0.5f, 1.0f});
    }
    writer.write(1, 0, picture);
    const auto holds = [&](PicturePass pass, const std::vector<ExrChannel>& channels) {
        CHECK((test::bytes_of(files.pass(1, pass)) == encode_exr(3, 1, channels)));
    };
    const auto flat = [](float value) { return std::vector<float>(3, value); };
    holds(PicturePass::normal,
          {{"normal.X", {1, 0, 0}}, {"normal.Y", {0, 1, 0}}, {"normal.Z", {0, 0, 1}}});
    holds(PicturePass::motion, {{"forward.u", flat(1)},
                                {"forward.v", flat(2)},
                                {"backward.u", flat(3)},
                                {"backward.v", flat(4)}});
    holds(PicturePass::beauty, {{"R", flat(0.125f), true},
                                {"G", flat(0.25f), true},
                                {"B", flat(0.5f), true},
                                {"A", flat(1), true}});
}
