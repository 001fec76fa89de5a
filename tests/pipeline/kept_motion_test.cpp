// SPDX-License-Identifier: GPL-3.0-or-later
// A motion file that is gone on with.
#include <fstream>

#include "base/error.h"
#include "pipeline/frame_store.h"
#include "tests/catch.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"

using namespace swage;
using test::bytes_of;
namespace fs = std::filesystem;

namespace {

TriMesh triangle(const std::string& image) {
    TriMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangle = {{0, 1, 2}};
    mesh.material.resize(1);
    mesh.material[0].embedded_texture = std::make_shared<const std::string>(image);
    return mesh;
}

void add_stage(FrameStoreWriter& writer, int stage) {
    CHECK(writer.add_machine({{"pusher", triangle("paint"), {1, 0, 0}}}) == stage);
    CHECK(writer.add_skin(triangle("hide")) == stage);
    for (int n = 0; n < 3; ++n) {
        StoredFrame frame;
        frame.machine = stage;
        frame.body.push_back({stage, {{0.1 * n, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
        frame.pose.resize(1);
        writer.add_frame(frame);
    }
}

}  // namespace

TEST_CASE("a motion file that is gone on with is the one that was written in one go") {
    const Scratch scratch;
    const fs::path whole = scratch.path() / "whole.bin", file = scratch.path() / "motion.bin",
                   kept = scratch.path() / "kept.bin";
    {
        FrameStoreWriter writer(whole);
        for (int stage : {0, 1, 2}) add_stage(writer, stage);
        writer.finish();
    }
    MotionMark mark;
    {
        FrameStoreWriter writer(file);
        add_stage(writer, 0);
        writer.keep(kept);
        mark = writer.mark();
        add_stage(writer, 1);
        SECTION("where the process was killed") {}
        SECTION("where the run was ended") {
            writer.finish();
            CHECK_FALSE(fs::exists(kept));
        }
        SECTION("where it was killed within a record") {
            fs::resize_file(kept, fs::file_size(kept) - 37);
        }
    }
    const fs::path from = fs::exists(kept) ? kept : file;
    const std::string before = bytes_of(from);
    REQUIRE(holds_motion(from, mark));
    {
        FrameStoreWriter writer(file, from, mark);
        CHECK(writer.frame_count() == 3);
        if (from == file) CHECK(bytes_of(file) == before);  // as long as the other is not whole
        add_stage(writer, 1);
        writer.keep(kept);
        const MotionMark second = writer.mark();
        CHECK(holds_motion(kept, mark));
        CHECK(holds_motion(kept, second));
        add_stage(writer, 2);
        writer.finish();
    }
    CHECK(bytes_of(file) == bytes_of(whole));
    CHECK_FALSE(fs::exists(kept));
}

TEST_CASE("a motion file that ends before a mark, or is another there, is not gone on with") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "motion.bin", other = scratch.path() / "other.bin";
    CHECK_FALSE(holds_motion(file, {}));
    MotionMark mark;
    {
        FrameStoreWriter writer(file);
        add_stage(writer, 0);
        mark = writer.mark();
        writer.finish();
    }
    REQUIRE(holds_motion(file, mark));
    CHECK_FALSE(holds_motion(file, {mark.size, mark.hash + 1}));
    CHECK_FALSE(holds_motion(file, {mark.size - 1, mark.hash}));
    CHECK_FALSE(holds_motion(scratch.path(), mark));
    const std::string whole = bytes_of(file);
    for (std::size_t at = 0; at < mark.size; ++at) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ 1);
        std::ofstream(other, std::ios::binary) << bytes;
        CHECK_FALSE(holds_motion(other, mark));
        std::ofstream(other, std::ios::binary) << whole.substr(0, at);
        CHECK_FALSE(holds_motion(other, mark));
    }
    CHECK_THROWS_AS(FrameStoreWriter(file, other, mark), Error);
    CHECK_THROWS_AS(FrameStoreWriter(file, scratch.path() / "none.bin", mark), Error);
    CHECK(bytes_of(file) == whole);
}
