// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/frame_store.h"

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>
#include <iterator>

#include "base/error.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

namespace {

TriMesh tetrahedron() {
    TriMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.1}};
    mesh.triangle = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    mesh.uv = {{0, 0}, {1, 0.25}};
    mesh.triangle_uv = {{0, 1, -1}, {0, 0, 0}, {1, 1, 1}, {0, 1, 0}};
    mesh.smooth_group_count = 3;
    mesh.triangle_smooth = {{0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}};
    mesh.triangle_material = {0, 0, 1, 1};
    mesh.material.resize(2);
    mesh.material[1].name = "hide";
    mesh.material[1].color = {0.1, 0.2, 0.3};
    mesh.material[1].clear = 0.4;
    mesh.material[1].texture = "/somewhere/hide.png";
    mesh.material[0].embedded_texture = std::make_shared<const std::string>("PNG and so on");
    mesh.triangle_part = {0, 0, 0, 0};
    mesh.part_name = {"body"};
    return mesh;
}

StoredFrame some_frame(int number) {
    StoredFrame frame;
    for (int b = 0; b < 2; ++b) {
        frame.body.push_back({(number + b) % 2, {}});
        for (int v = 0; v < 4; ++v) {
            frame.body[b].position.emplace_back(number + 0.5f * v, v + b, -v);
        }
    }
    frame.pose.push_back(
        {Quat(Eigen::AngleAxisd(0.1 * number, Vec3::UnitZ())), {1, 2, 1.0 * number}});
    return frame;
}

void write_store(const fs::path& file, int frames) {
    FrameStoreWriter writer(file);
    CHECK(writer.add_skin(tetrahedron()) == 0);
    CHECK(writer.add_skin(tetrahedron()) == 1);
    CHECK(writer.add_machine({{"pusher", tetrahedron(), {1, 0, 0}}}) == 0);
    for (int f = 0; f < frames; ++f) writer.add_frame(some_frame(f));
    writer.finish();
}

}  // namespace

TEST_CASE("a motion file gives back what was put in") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin";
    write_store(file, 5);
    const FrameStore store(file);
    REQUIRE(store.frame_count() == 5);
    CHECK(store.machine_count() == 1);
    for (int f : {4, 0, 2}) {
        const StoredFrame frame = store.frame(f), expected = some_frame(f);
        REQUIRE(frame.body.size() == expected.body.size());
        for (std::size_t b = 0; b < frame.body.size(); ++b) {
            CHECK(frame.body[b].skin == expected.body[b].skin);
            CHECK(frame.body[b].position == expected.body[b].position);
        }
        CHECK(frame.pose[0].rotation.coeffs() == expected.pose[0].rotation.coeffs());
        CHECK(frame.pose[0].translation == expected.pose[0].translation);
    }
    const TriMesh skin = store.skin(1), expected = tetrahedron();
    CHECK(skin.position == expected.position);
    CHECK(skin.triangle == expected.triangle);
    CHECK(skin.uv == expected.uv);
    CHECK(skin.triangle_uv == expected.triangle_uv);
    CHECK(skin.smooth_group_count == 3);
    CHECK(skin.triangle_material == expected.triangle_material);
    CHECK(skin.material[1].name == "hide");
    CHECK(skin.material[1].texture == "/somewhere/hide.png");
    CHECK(skin.material[1].color == Vec3(0.1, 0.2, 0.3));
    CHECK(skin.material[1].clear == 0.4);
    REQUIRE(skin.material[0].embedded_texture);
    CHECK(*skin.material[0].embedded_texture == "PNG and so on");
    CHECK_FALSE(skin.material[1].embedded_texture);
    CHECK(skin.part_name == expected.part_name);
    const std::vector<DrawnPart> machine = store.machine(0);
    CHECK(machine[0].name == "pusher");
    CHECK(machine[0].color == Vec3(1, 0, 0));
}

TEST_CASE("a motion file holds fields where they are asked for, and is what it was where not") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin", plain = scratch.path() / "plain.bin";
    const std::vector<SkinField> fields = {SkinField::stress, SkinField::plastic_strain};
    const auto with_fields = [&](int number) {
        StoredFrame frame = some_frame(number);
        for (StoredBody& body : frame.body) {
            body.field = {{1, 2, 3, float(number)}, {0, 0.5f, 0, 0.25f}};
        }
        return frame;
    };
    {
        FrameStoreWriter writer(file, fields);
        for (int f = 0; f < 3; ++f) writer.add_frame(with_fields(f));
        writer.keep(scratch.path() / "kept");
        const MotionMark mark = writer.mark();
        CHECK(holds_motion(scratch.path() / "kept", mark));
        FrameStoreWriter on(file, scratch.path() / "kept", mark);
        on.add_frame(with_fields(3));
        on.finish();
    }
    const FrameStore store(file);
    REQUIRE(store.frame_count() == 4);
    CHECK(store.fields() == fields);
    for (int f = 0; f < 4; ++f) {
        for (const StoredBody& body : store.frame(f).body) {
            CHECK(body.field == with_fields(f).body[0].field);
        }
    }
    // Fields that nobody asked for are not kept.
    FrameStoreWriter none(plain);
    none.add_frame(with_fields(0));
    none.finish();
    CHECK(FrameStore(plain).fields().empty());
    CHECK(FrameStore(plain).frame(0).body[0].field.empty());
    FrameStoreWriter bare(file);
    bare.add_frame(some_frame(0));
    bare.finish();
    CHECK(fs::file_size(file) == fs::file_size(plain));
}

TEST_CASE("an image within meshes is stored once, for however many skins") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin";
    FrameStoreWriter writer(file);
    TriMesh mesh = tetrahedron();
    const auto image = std::make_shared<const std::string>(100'000, 'x');
    mesh.material[0].embedded_texture = image;
    for (int skin = 0; skin < 10; ++skin) {
        mesh.material[0].embedded_texture = std::make_shared<const std::string>(*image);
        writer.add_skin(mesh);
    }
    writer.finish();
    CHECK(fs::file_size(file) < 120'000);
    const FrameStore store(file);
    for (int skin : {0, 9}) CHECK(*store.skin(skin).material[0].embedded_texture == *image);
}

TEST_CASE("where a body is far away its frame is as exact as near by") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin";
    FrameStoreWriter writer(file);
    StoredFrame frame;
    frame.body.push_back(
        {0, {{1e6, 0, -1e6}, {1e6 + 0.1, 0.03, -1e6}, {1e6 + 0.2, 0, -1e6 + 0.07}}});
    writer.add_frame(frame);
    writer.finish();
    const StoredFrame back = FrameStore(file).frame(0);
    for (int v = 0; v < 3; ++v) {
        CHECK((back.body[0].position[v] - frame.body[0].position[v]).norm() < 1e-7 * 0.2);
    }
}

TEST_CASE("a motion file appears only when it is whole") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin";
    {
        FrameStoreWriter writer(file);
        writer.add_skin(tetrahedron());
        CHECK_FALSE(fs::exists(file));
    }
    CHECK(fs::is_empty(scratch.path()));
}

TEST_CASE("what was written before the disk was full is kept") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin";
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    FrameStoreWriter writer(file);
    CHECK(writer.add_skin(tetrahedron()) == 0);
    CHECK(writer.add_skin(tetrahedron()) == 1);
    writer.add_machine({{"pusher", tetrahedron(), {1, 0, 0}}});
    for (int f = 0; f < 2; ++f) writer.add_frame(some_frame(f));
    StoredFrame large = some_frame(2);
    large.body[0].position.resize(10'000);
    const rlimit full{20'000, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
    CHECK_THROWS_AS(writer.add_frame(large), Error);
    writer.finish();
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    const FrameStore store(file);
    REQUIRE(store.frame_count() == 2);
    CHECK(store.frame(1).body[0].position == some_frame(1).body[0].position);
}

TEST_CASE("a frame that leaves no room for the file's end is not kept, and those before it are") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin";
    write_store(file, 3);
    const std::uintmax_t whole = fs::file_size(file);
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit full{whole - 1, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
    {
        FrameStoreWriter writer(file);
        for (int skin = 0; skin < 2; ++skin) writer.add_skin(tetrahedron());
        writer.add_machine({{"pusher", tetrahedron(), {1, 0, 0}}});
        for (int f = 0; f < 2; ++f) writer.add_frame(some_frame(f));
        CHECK_THROWS_AS(writer.add_frame(some_frame(2)), Error);
        CHECK_NOTHROW(writer.finish());
    }
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    CHECK(fs::file_size(file) < whole);
    CHECK(FrameStore(file).frame_count() == 2);
}

TEST_CASE("a damaged motion file is refused") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin";
    write_store(file, 3);
    const auto size = fs::file_size(file);
    SECTION("cut short") {
        fs::resize_file(file, size - 40);
        CHECK_THROWS_AS(FrameStore(file), Error);
    }
    SECTION("one byte changed") {
        std::fstream change(file, std::ios::in | std::ios::out | std::ios::binary);
        change.seekp(static_cast<std::streamoff>(size) - 40);
        change.put('x');
        change.close();
        const FrameStore store(file);
        CHECK_NOTHROW(store.frame(1));
        CHECK_THROWS_AS(store.frame(2), Error);
    }
    SECTION("a record called another kind") {
        // The first head follows the magic word; of a skin a machine is made.
        std::fstream change(file, std::ios::in | std::ios::out | std::ios::binary);
        change.seekp(8);
        change.put(2);
        change.close();
        CHECK_THROWS_AS(FrameStore(file), Error);
    }
    SECTION("something else") {
        std::ofstream(file) << "not a motion file at all";
        CHECK_THROWS_AS(FrameStore(file), Error);
    }
    SECTION("what would keep a reader waiting") {
        fs::remove(file);
        REQUIRE(::mkfifo(file.c_str(), 0600) == 0);
        CHECK_THROWS_AS(FrameStore(file), Error);
    }
    SECTION("absent") { CHECK_THROWS_AS(FrameStore(scratch.path() / "none.bin"), Error); }
}

TEST_CASE("a motion file that is refused is not held open, nor is one that could not begin") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin";
    write_store(file, 1);
    fs::resize_file(file, fs::file_size(file) - 4);
    const auto open_files = [] {
        const fs::directory_iterator all("/proc/self/fd");
        return std::distance(begin(all), end(all));
    };
    const auto before = open_files();
    CHECK_THROWS_AS(FrameStore(file), Error);
    CHECK_THROWS_WITH(FrameStore(scratch.path()), Catch::EndsWith("is a folder, not a file"));
    CHECK_THROWS_AS(FrameStoreWriter(scratch.path() / "none" / "motion.bin"), Error);
    CHECK(open_files() == before);
}
