// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/piece_track.h"

#include <set>

#include "geometry/box_mesh.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace fs = std::filesystem;

namespace {

// Boxes beside each other along x, from each end to the next.
TriMesh boxes(const std::vector<std::pair<double, double>>& ends) {
    TriMesh all;
    for (const auto& [from, to] : ends) {
        const TriMesh one = box_mesh(Vec3(from, 0, 0), Vec3(to, 1, 1));
        const int first = static_cast<int>(all.position.size());
        all.position.insert(all.position.end(), one.position.begin(), one.position.end());
        for (const Corners& c : one.triangle) {
            all.triangle.push_back({c[0] + first, c[1] + first, c[2] + first});
        }
    }
    return all;
}

constexpr int kTrianglesOfBox = 12;

// The piece of each box of such a mesh.
std::vector<int> of_boxes(const PieceTrack& track, int skin, const TriMesh& mesh) {
    const std::vector<int> of_triangle = track.of_triangles(0, skin, mesh);
    std::vector<int> piece;
    for (std::size_t t = 0; t < of_triangle.size(); ++t) {
        if (t % kTrianglesOfBox == 0) piece.push_back(of_triangle[t]);
        CHECK(of_triangle[t] == piece.back());
    }
    return piece;
}

// A frame of each of them.
fs::path put_store(const Scratch& scratch, const std::vector<TriMesh>& skins) {
    const fs::path file = scratch.path() / "motion.bin";
    FrameStoreWriter writer(file);
    writer.add_machine({});
    for (const TriMesh& skin : skins) {
        StoredFrame frame;
        frame.body = {{writer.add_skin(skin), skin.position}};
        writer.add_frame(frame);
    }
    writer.finish();
    return file;
}

}  // namespace

TEST_CASE(
    "a piece keeps its number, in whatever order a skin has it, and what comes off it has one of "
    "its own") {
    const Scratch scratch;
    const std::vector<TriMesh> skins = {
        boxes({{0, 10}}), boxes({{0, 4}, {4, 10}}), boxes({{0, 4}, {9.2, 10}, {4, 9.2}}),
        boxes({{9.2, 10}, {4, 9.2}, {0, 1}, {1, 4}}), boxes({{0, 1}, {1, 9.2}, {9.2, 10}})};
    {
        FrameStoreWriter writer(scratch.path() / "motion.bin");
        writer.add_machine({});
        for (const TriMesh& skin : skins) {
            const int id = writer.add_skin(skin);
            for (int n = 0; n < 2; ++n) {  // fallen a long way meanwhile
                StoredFrame frame;
                frame.body = {{id, skin.position}};
                for (Vec3& p : frame.body[0].position) p.y() -= 7 * id + n;
                writer.add_frame(frame);
            }
        }
        writer.finish();
    }
    const FrameStore store(scratch.path() / "motion.bin");
    const PieceTrack track(store);
    CHECK(of_boxes(track, 0, skins[0]) == std::vector<int>{0});
    CHECK(of_boxes(track, 1, skins[1]) == std::vector<int>{1, 0});
    CHECK(of_boxes(track, 2, skins[2]) == std::vector<int>{1, 2, 0});
    CHECK(of_boxes(track, 3, skins[3]) == std::vector<int>{2, 0, 1, 3});
    // Joined again: that of the larger part, and the other comes last.
    CHECK(of_boxes(track, 4, skins[4]) == std::vector<int>{1, 0, 2});
    CHECK(track.count(0) == 4);
    CHECK(track.first_frame(0, 0) == 1);
    CHECK(track.first_frame(0, 1) == 3);
    CHECK(track.first_frame(0, 2) == 5);
    CHECK(track.first_frame(0, 3) == 7);
}

TEST_CASE("pieces are numbered by what they come to be, and a body is the first of its own") {
    const Scratch scratch;
    // The larger part is broken again, so that the other becomes the largest.
    const std::vector<TriMesh> skins = {boxes({{0, 10}}), boxes({{0, 4}, {4, 10}}),
                                        boxes({{0, 4}, {4, 7}, {7, 10}})};
    const FrameStore store(put_store(scratch, skins));
    const int box = kTrianglesOfBox;
    const PieceTrack by_volume(store), told(store, {{3, {{2 * box}, {1}, {box + 5}}}}),
        of_another_time(store, {{2, {{2 * box}, {1}, {box + 5}}}}),
        nonsense(store, {{3, {{-1}, {999}}}});
    for (const PieceTrack* track : {&by_volume, &of_another_time, &nonsense}) {
        CHECK(of_boxes(*track, 0, skins[0]) == std::vector<int>{0});
        CHECK(of_boxes(*track, 1, skins[1]) == std::vector<int>{0, 1});
        CHECK(of_boxes(*track, 2, skins[2]) == std::vector<int>{0, 1, 2});
        CHECK(track->first_frame(0, 1) == 2);
        CHECK(track->first_frame(0, 2) == 3);
    }
    CHECK(of_boxes(told, 1, skins[1]) == std::vector<int>{1, 0});
    CHECK(of_boxes(told, 2, skins[2]) == std::vector<int>{1, 2, 0});
}

TEST_CASE("a body of several shells is one piece as it starts") {
    const Scratch scratch;
    const TriMesh two = boxes({{0, 1}, {2, 5}}), three = boxes({{0, 1}, {2, 3}, {3, 5}});
    const FrameStore store(put_store(scratch, {two, three}));
    const PieceTrack track(store);
    CHECK(of_boxes(track, 0, two) == std::vector<int>{0, 0});
    CHECK(of_boxes(track, 1, three) == std::vector<int>{0, 1, 0});
    // As long as it is told to be one.
    const PieceTrack told(store, {{2, {}}});
    CHECK(of_boxes(told, 1, three) == std::vector<int>{0, 0, 0});
    CHECK(told.count(0) == 1);
}

TEST_CASE("all shells of a piece have its number, from where it comes off what it was part of") {
    const Scratch scratch;
    const int box = kTrianglesOfBox;
    // The last is a stud on what comes off, and on what comes off that.
    const std::vector<TriMesh> skins = {boxes({{0, 10}, {12, 13}}),
                                        boxes({{0, 4}, {4, 10}, {12, 13}}),
                                        boxes({{0, 4}, {4, 6}, {6, 10}, {12, 13}})};
    const FrameStore store(put_store(scratch, skins));
    SECTION("it comes off what came off") {
        const PieceTrack track(store, {{3, {{1}, {box}, {2 * box, 3 * box}}}});
        CHECK(of_boxes(track, 0, skins[0]) == std::vector<int>{0, 0});
        CHECK(of_boxes(track, 1, skins[1]) == std::vector<int>{0, 1, 1});
        CHECK(of_boxes(track, 2, skins[2]) == std::vector<int>{0, 1, 2, 2});
        REQUIRE(track.count(0) == 3);
        for (int p : {0, 1, 2}) CHECK(track.first_frame(0, p) == p + 1);
    }
    SECTION("it comes off first") {
        const PieceTrack track(store, {{3, {{1}, {2 * box, 3 * box}, {box}}}});
        CHECK(of_boxes(track, 0, skins[0]) == std::vector<int>{0, 0});
        CHECK(of_boxes(track, 1, skins[1]) == std::vector<int>{0, 1, 1});
        CHECK(of_boxes(track, 2, skins[2]) == std::vector<int>{0, 2, 1, 1});
    }
    SECTION("it is what the body stays") {
        const PieceTrack track(store, {{3, {{2 * box, 3 * box}, {1}, {box}}}});
        CHECK(of_boxes(track, 1, skins[1]) == std::vector<int>{1, 0, 0});
        CHECK(of_boxes(track, 2, skins[2]) == std::vector<int>{1, 2, 0, 0});
    }
    SECTION("of an older run only the largest shell is told") {
        const PieceTrack track(store, {{3, {{1}, {2 * box}, {box}}}});
        CHECK(of_boxes(track, 2, skins[2]) == std::vector<int>{0, 2, 1, 0});
    }
}

TEST_CASE("pieces of shells that were there from the start have numbers of their own") {
    const Scratch scratch;
    const int box = kTrianglesOfBox;
    const TriMesh two = boxes({{0, 4}, {5, 8}}), four = boxes({{0, 1}, {1, 4}, {5, 6}, {6, 8}}),
                  left = boxes({{0, 1}, {1, 4}, {5, 8}});
    SECTION("from where anything comes off") {
        const FrameStore store(put_store(scratch, {two, left, four}));
        const PieceTrack track(store, {{3, {{box}, {3 * box}, {0}, {2 * box}}}});
        CHECK(of_boxes(track, 0, two) == std::vector<int>{0, 0});
        CHECK(of_boxes(track, 1, left) == std::vector<int>{2, 0, 1});
        CHECK(of_boxes(track, 2, four) == std::vector<int>{2, 0, 3, 1});
        REQUIRE(track.count(0) == 4);
        CHECK(track.first_frame(0, 1) == 2);
        CHECK(track.first_frame(0, 2) == 2);
        CHECK(track.first_frame(0, 3) == 3);
    }
    SECTION("from the start, as nothing comes off") {
        const FrameStore store(put_store(scratch, {two}));
        const PieceTrack track(store, {{1, {{box}, {0}}}});
        CHECK(of_boxes(track, 0, two) == std::vector<int>{1, 0});
        CHECK(track.first_frame(0, 1) == 1);
    }
}
