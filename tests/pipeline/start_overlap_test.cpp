// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_overlap.h"

#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "scene/find.h"
#include "scene/read_machine.h"
#include "tests/catch.h"
#include "tests/scene/scene_folder.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

// Of a cube of 20 cm about the origin its top is at y = -0.3; 4 m by 4 m, 0.2 m thick.
Machine floor_under(const Aggregate& work_piece) {
    const MachineReading floor =
        read_machine(std::filesystem::path(SWAGE_SOURCE_DIR) / "machines/floor.toml");
    REQUIRE(floor.machine);
    return build_machine(*floor.machine, {},
                         place_work_frame(work_piece, WorldAxis::x, WorldAxis::y, true),
                         work_piece);
}

}  // namespace

TEST_CASE("bodies that lie in each other at the start are told, those that touch are not") {
    const Aggregate one = test::make_block(4, 4, 4, 0.1, Material{});
    const auto told = [&](double spacing, int across, double away) {
        Aggregate other = test::make_block(across, across, across, spacing, Material{});
        for (double& x : other.particle_position.x) x += away;
        return start_overlaps({{"one", &one}, {"other", &other}});
    };
    CHECK(told(0.1, 4, 0.4).empty());  // face on face
    CHECK(told(0.04, 5, 0.301).empty());
    CHECK(told(0.1, 4, 1).empty());
    REQUIRE(told(0.1, 4, 0.3).size() == 1);
    CHECK(told(0.1, 4, 0.3)[0].find("\"one\" and \"other\"") != std::string::npos);
    CHECK(told(0.1, 4, 0.3)[0].find("about 0.016 m3: they") != std::string::npos);
    CHECK(told(0.04, 5, 0.1).size() == 1);
    CHECK(told(0.04, 5, 0.03).size() == 1);  // wholly inside
    // A little deep: an eighth of the smaller cells, not a thirtieth.
    for (const auto& [spacing, across, touches] :
         {std::tuple(0.1, 4, 0.4), std::tuple(0.04, 5, 0.3)}) {
        INFO(spacing);
        CHECK(told(spacing, across, touches - 0.03 * spacing).empty());
        const std::vector<std::string> deep = told(spacing, across, touches - 0.125 * spacing);
        REQUIRE(deep.size() == 1);
        CHECK(deep[0].find("deep in each other, which throws them apart") != std::string::npos);
    }
    CHECK(told(0.1, 4, 0.388)[0].find("start 1.2 cm deep") != std::string::npos);
}

TEST_CASE("bodies of which many start in each other are told in one line that names the worst") {
    for (const double deeper : {0.005, 0.1}) {
        std::vector<Aggregate> row(4, test::make_block(3, 3, 3, 0.1, Material{}));
        const double at[] = {0, 0.3, 0.6 - deeper, 0.9 - 3 * deeper};
        std::vector<NamedMatter> named;
        for (int n = 0; n < 4; ++n) {
            for (double& x : row[n].particle_position.x) x += at[n];
            named.push_back({std::string(1, char('a' + n)), &row[n]});
        }
        const std::vector<std::string> told = start_overlaps(named);
        INFO(deeper);
        REQUIRE(told.size() == 1);
        CHECK(told[0].find("\"c\" and \"d\"") == 0);
        CHECK(told[0].find(", as does 1 other pair") != std::string::npos);
    }
}

TEST_CASE("bodies share no more than the smaller of them holds, about what they do") {
    const auto ball = [](double radius, double x) {
        MoldSettings settings;
        settings.spacing = 0.02;
        Aggregate ball =
            mold(make_shape("sphere", {{"diameter", 2 * radius}}).mesh, Material{}, settings);
        for (double& at : ball.particle_position.x) at += x;
        return ball;
    };
    const auto shared = [](const Aggregate& one, const Aggregate& other) {
        const std::vector<std::string> told = start_overlaps({{"one", &one}, {"other", &other}});
        REQUIRE(told.size() == 1);
        const std::string word = "about ";
        return std::stod(told[0].substr(told[0].find(word) + word.size()));  // [cm3]
    };
    const Aggregate large = ball(0.06, 0), small = ball(0.04, 0.005), aside = ball(0.06, 0.05);
    const double most = 1e6 * small.volume();
    CHECK(shared(large, large) == Approx(1e6 * large.volume()).epsilon(0.02));
    CHECK(shared(large, large) <= 1e6 * large.volume() * 1.0001);
    CHECK(shared(small, large) == Approx(most).epsilon(0.02));
    CHECK(shared(large, small) == Approx(most).epsilon(0.25));
    CHECK(shared(large, small) <= most * 1.0001);
    // A lens: pi / 12 (4 R + d) (2 R - d)^2.
    CHECK(shared(large, aside) == Approx(371.6).epsilon(0.05));
}

TEST_CASE(
    "round bodies that touch, or with air between them, do not lie in each other, whatever their "
    "cells hold") {
    for (const double a : {0.022, 0.03, 0.041}) {
        const auto ball = [&](double x) {
            const int count = static_cast<int>(0.14 / a) + 2;
            const Vec3 middle(x, 0, 0);
            return test::make_shape([&](const Vec3& p) { return (p - middle).norm() - 0.06; },
                                    middle - Vec3::Constant(0.07), Vec3i::Constant(count), a);
        };
        const Aggregate one = ball(0);
        for (const double away : {0.12, 0.1205, 0.123, 0.13}) {
            const Aggregate other = ball(away);
            INFO(a << " " << away);
            CHECK(start_overlaps({{"one", &one}, {"other", &other}}).empty());
        }
        const Aggregate in_it = ball(0.07);
        CHECK(start_overlaps({{"one", &one}, {"other", &in_it}}).size() == 1);
    }
}

TEST_CASE("bodies of which many have nothing to lie on are told in one line") {
    const Aggregate work_piece = test::make_block(2, 2, 2, 0.1, Material{});
    const Machine machine = floor_under(work_piece);
    std::vector<Aggregate> row(5, work_piece);
    for (int n = 0; n < 5; ++n) {
        for (double& z : row[n].particle_position.z) z += 1.5 + n;
    }
    std::vector<NamedMatter> all = {{"cube", &work_piece}};
    const auto told = [&](int bodies) {
        all.resize(1);
        for (int n = 0; n < bodies; ++n) all.push_back({std::string(1, char('a' + n)), &row[n]});
        return tool_overlaps(machine, all);
    };
    const std::string edge = " past the edge of tool floor of machine floor, which is placed by ",
                      do_so = ": move the bodies with `at`, or make the tool larger or lower";
    CHECK(told(1).empty());
    REQUIRE(told(2).size() == 1);
    CHECK(told(2)[0].find("\"b\" starts with its middle" + edge) == 0);
    REQUIRE(told(3).size() == 1);
    CHECK(told(3)[0].find("\"b\" starts with its middle, as does 1 other body," + edge) == 0);
    REQUIRE(told(5).size() == 1);
    CHECK(told(5)[0].find("\"b\" starts with its middle, as do 3 other bodies," + edge) == 0);
    CHECK(told(5)[0].find(do_so) != std::string::npos);
}

TEST_CASE("a body beside the work-piece that starts in, beyond or under the floor is told") {
    const Aggregate work_piece = test::make_block(2, 2, 2, 0.1, Material{});
    const Machine machine = floor_under(work_piece);
    int other_cells = 4;
    bool to_move_as_molded = false;
    const auto told = [&](const Vec3& at) {
        const double side = other_cells == 1 ? 0.8 : 0.05;
        Aggregate other = test::make_block(other_cells, other_cells, other_cells, side, Material{});
        for (std::size_t p = 0; p < other.particle_count(); ++p) {
            other.particle_position.set(p, other.particle_position.at(p) + at);
        }
        const std::vector<std::string> all =
            tool_overlaps(machine, {{"cube", &work_piece}, {"other", &other}}, to_move_as_molded);
        CHECK(all.size() <= 1);
        return all.empty() ? "" : all[0];
    };
    CHECK(told({1, 0, 0}) == "");
    CHECK(told({1.95, -0.2, 0}) == "");
    CHECK(told({0, -0.205, 0}) == "");  // as deep as what lies on it
    CHECK(told({0, -0.25, 0}).find("\"other\" starts 5 cm deep in tool floor") == 0);
    CHECK(told({0, -0.45, 0}).find("deep in tool floor") != std::string::npos);
    // Its points stride over the floor.
    other_cells = 1;
    CHECK(told({0, -0.35, 0}).find("deep in tool floor") != std::string::npos);
    other_cells = 4;
    CHECK(told({0, -0.9, 0}).find("starts with its middle on the far side of tool floor") !=
          std::string::npos);
    CHECK(told({0, 0.1, 2.1}).find("starts with its middle past the edge of tool floor") !=
          std::string::npos);
    to_move_as_molded = true;
    CHECK(told({0, -0.205, 0}).find("\"other\" starts 5 mm deep in tool floor") == 0);
    for (const double off : {-1e-3, 0.0, 1e-3}) CHECK(told({0, -0.2 + off, 0}) == "");
    Aggregate sunk = work_piece;
    for (double& y : sunk.particle_position.y) y -= 0.21;
    CHECK(tool_overlaps(machine, {{"cube", &sunk}}).empty());
    const std::vector<std::string> own = tool_overlaps(machine, {{"cube", &sunk}}, true);
    REQUIRE(own.size() == 1);
    CHECK(own[0] ==
          "\"cube\" starts 1 cm deep in tool floor of machine floor: move the tool further away");
}
