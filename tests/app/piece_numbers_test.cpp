// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces have one order, in meshes and in passes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "geometry/mesh_read.h"
#include "pipeline/frame_store.h"
#include "pipeline/piece_track.h"
#include "pipeline/run_record.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/box_obj.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;
using swage::test::box_obj;

namespace {

struct Surface {
    double area = 0;
    swage::Vec3 middle = swage::Vec3::Zero();
};

// Of each number that triangles have.
std::vector<Surface> surfaces_of(const swage::TriMesh& mesh,
                                 const std::vector<swage::Vec3>& position,
                                 const std::vector<int>& number) {
    std::vector<Surface> all;
    REQUIRE(number.size() == mesh.triangle.size());
    for (std::size_t t = 0; t < number.size(); ++t) {
        all.resize(std::max(all.size(), std::size_t(number[t]) + 1));
        const auto [a, b, c] = mesh.triangle[t];
        const double own = 0.5 * swage::area_vector(position, mesh.triangle[t]).norm();
        all[number[t]].area += own;
        all[number[t]].middle += own * (position[a] + position[b] + position[c]) / 3;
    }
    for (Surface& one : all) one.middle /= one.area;
    return all;
}

struct Numbers {
    std::vector<int> shells;  // of each piece, in the last frame
    std::vector<int> from;    // the frame that it comes in
};

// Of a body of a run, whose pieces are checked against the objects of its last mesh.
Numbers numbers_of(const fs::path& run, std::size_t body, const std::string& obj) {
    const swage::FrameStore store(run / "motion.bin");
    const swage::PieceTrack track(
        store, swage::run_names_of(parse_json(bytes_of(run / "run.json"))).piece);
    const swage::StoredBody last = store.frame(store.frame_count() - 1).body.at(body);
    const swage::TriMesh skin = store.skin(last.skin);
    const std::vector<int> piece = track.of_triangles(body, last.skin, skin);
    const swage::TriMesh mesh = swage::read_mesh(run / "meshes" / obj);
    const std::vector<Surface> here = surfaces_of(skin, last.position, piece),
                               there = surfaces_of(mesh, mesh.position, mesh.triangle_part);
    CHECK(track.count(body) == int(there.size()));
    REQUIRE(here.size() == there.size());
    for (std::size_t p = 0; p < here.size(); ++p) {
        CAPTURE(p);
        CHECK(here[p].area == Approx(there[p].area).epsilon(1e-4));
        CHECK((here[p].middle - there[p].middle).norm() < 1e-4);
    }
    Numbers numbers;
    const swage::Components shells = swage::surface_components(skin);
    std::vector<std::set<int>> own(here.size());
    for (std::size_t t = 0; t < piece.size(); ++t) {
        own[piece[t]].insert(shells.triangle_component[t]);
    }
    for (const std::set<int>& one : own) numbers.shells.push_back(int(one.size()));
    for (int p = 0; p < track.count(body); ++p) numbers.from.push_back(track.first_frame(body, p));
    return numbers;
}

// The first stage ends with frame 3, as the start is the first.
std::string cut_at(double place, const std::string& more = "") {
    return fmt::format("[[stage]]\nmachine = \"cut\"\nframes = 2\nplace = {}\n", place) + more;
}

struct Line {
    std::string name, mesh, more;
    std::vector<std::string> stages;
    std::vector<std::string> obj;  // of each body
    Numbers numbers;               // of each of them
};

}  // namespace

TEST_CASE("the number of a piece is that of its object, of however many shells it is", "[stress]") {
    // A part in a gap of less than a cell above another: both are one body of two shells.
    const std::string bar = box_obj({0, 0, 0}, {.3, .06, .06}, 0, "bar"),
                      stud = bar + box_obj({.262, .0605, .012}, {.295, .09, .048}, 8, "stud");
    // That a blade goes through both of, and that it goes between.
    const std::string two = box_obj({0, 0, 0}, {.2, .04, .03}) +
                            box_obj({0, 0, .07}, {.2, .04, .1}, 8),
                      layers = box_obj({0, 0, 0}, {.08, .02, .08}) +
                               box_obj({0, .023, 0}, {.08, .043, .08}, 8);
    const std::string other =
        "[[body]]\nname = \"other\"\nfile = \"mesh.obj\"\n"
        "at = [\"15 cm\", \"4.5 cm\", \"12 cm\"]\n";
    const std::string wide = "blade_width = \"60 cm\"\n";
    const std::vector<Line> lines = {
        {"cut twice", bar, "", {cut_at(-.1), cut_at(.2)}, {"2-cut"}, {{1, 1, 1}, {1, 2, 4}}},
        {"stud", stud, "", {cut_at(0)}, {"1-cut"}, {{2, 1}, {1, 2}}},  // its half weighs more
        {"stud on what is cut again",
         stud,
         "",
         {cut_at(-.1), cut_at(.2)},
         {"2-cut"},
         {{1, 2, 1}, {1, 2, 4}}},
        {"two shells", two, "", {cut_at(.1)}, {"1-cut"}, {{1, 1, 1, 1}, {1, 2, 2, 2}}},
        {"boundary, molded anew",
         stud,
         "[skin]\nkind = \"boundary\"\n",
         {cut_at(.2), cut_at(-.2, "remold = true\n")},
         {"2-cut"},
         {{1, 1, 1}, {1, 4, 2}}},
        {"between shells",
         layers,
         "",
         {"[[stage]]\nmachine = \"slice\"\nslices = 2\naxis = \"y\"\nframes = 2\n"},
         {"1-slice"},
         {{1, 1}, {1, 1}}},
        {"two bodies",
         stud,
         other,
         {cut_at(.1, wide)},
         {"1-cut-work-piece", "1-cut-other"},
         {{1, 2}, {1, 2}}},
    };
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", out = scratch.path() / "out";
    const auto run = [&](const Line& line, std::size_t stages, const std::string& how) {
        std::string text =
            "[mesh]\nfile = \"mesh.obj\"\n[material]\nname = \"clay\"\n"
            "[mold]\nspacing = \"1 cm\"\n" +
            line.more;
        for (std::size_t n = 0; n < stages; ++n) text += line.stages[n];
        put_text(scratch.path() / "mesh.obj", line.mesh);
        put_text(scene, text);
        const Outcome outcome =
            run_swage({"run", scene.string(), "--no-render", how, "--out", out.string()});
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
    };
    const auto check = [&](const Line& line) {
        for (std::size_t b = 0; b < line.obj.size(); ++b) {
            const Numbers numbers = numbers_of(out, b, line.obj[b] + ".obj");
            CHECK(numbers.shells == line.numbers.shells);
            CHECK(numbers.from == line.numbers.from);
        }
    };
    for (const Line& line : lines) {
        INFO(line.name);
        run(line, line.stages.size(), "--fresh");
        check(line);
        if (line.stages.size() < 2) continue;
        run(line, 1, "--fresh");
        run(line, 2, "--go-on");
        check(line);
    }
}
