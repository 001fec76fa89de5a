// SPDX-License-Identifier: GPL-3.0-or-later
// Loads on parts of the surface.
#include "base/error.h"
#include "machines/machine.h"
#include "machines/region.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

// Its longest side along y, so the work frame's x is y, and its y is z.
Aggregate upright() { return make_block(3, 8, 4, 0.1, Material{}); }

Machine with(const Aggregate& matter, const LoadSpec& load) {
    MachineSpec spec;
    spec.name = "none";
    spec.load = {load};
    return build_machine(spec, {}, place_work_frame(matter), matter);
}

LoadSpec push(Side side) {
    LoadSpec load;
    load.name = "push";
    load.on = side;
    load.force = {"3*length", "-2", "0"};
    return load;
}

}  // namespace

TEST_CASE("the six sides share out the surface, and each looks where its name says") {
    const Aggregate matter = upright();
    const std::vector<std::pair<Side, Vec3>> sides = {
        {Side::left, -Vec3::UnitY()}, {Side::right, Vec3::UnitY()}, {Side::bottom, -Vec3::UnitZ()},
        {Side::top, Vec3::UnitZ()},   {Side::back, -Vec3::UnitX()}, {Side::front, Vec3::UnitX()}};
    std::size_t points = 0;
    for (const auto& [side, normal] : sides) {
        const Machine machine = with(matter, push(side));
        const Load& load = machine.apparatus.load.at(0);
        for (int p : load.point) CHECK(matter.surface.normal(p) == normal);
        CHECK_FALSE(load.closed);
        points += load.point.size();
    }
    CHECK(points == matter.surface.size());
}

TEST_CASE(
    "a force is shared evenly by area, in the work frame, over the part that its box leaves") {
    const Aggregate matter = upright();
    LoadSpec spec = push(Side::top);
    spec.box = {{{"0", "-height", "-width"}, {"length/4", "height", "width"}}};
    spec.strength = "t*t";
    const Machine machine = with(matter, spec);
    const Load& load = machine.apparatus.load.at(0);
    CHECK(load.point.size() == 2 * 3 * 4);
    Vec3 sum = Vec3::Zero();
    for (std::size_t n = 0; n < load.point.size(); ++n) {
        const double y = matter.surface_reference(load.point[n]).y();
        CHECK((y > 0 && y < 0.2));
        CHECK((load.force[n] - load.force[0]).norm() < 1e-15);
        sum += load.force[n];
    }
    CHECK((sum - Vec3(0, 2.4, -2)).norm() < 1e-6);
    spec.box = {{{"length/4", "height", "-width"}, {"0", "-height", "width"}}};
    CHECK(with(matter, spec).apparatus.load.at(0).point == load.point);  // any opposite corners
    CHECK(drive_at(machine, 0.5, 1).load_strength.at(0) == 0.25);
    CHECK(drive_at(machine, 0.5, 1).gravity_strength == 1);
}

TEST_CASE("of a side a box takes what lies in it, wherever its edges run") {
    const Aggregate matter = upright();  // 0.8 long, 0.4 high, 0.3 wide
    for (const double edge : {-0.31, -0.1, 0.0, 0.013, 0.049, 0.25}) {
        const Box box{Vec3(edge, -1, -0.07), Vec3(0.33, 1, 0.5)};
        const WorkFrame frame = place_work_frame(matter);
        std::vector<Vec3> in_work;
        for (const Vec3& p : surface_positions(matter)) {
            in_work.push_back(frame.world_from_work.inverse() * p);
        }
        const SurfacePart region =
            find_region(matter, frame.world_from_work, in_work, Side::top, &box);
        double area = 0;
        for (std::size_t n = 0; n < region.point.size(); ++n) {
            area += region.share_of(n) * matter.surface.area(region.point[n]);
        }
        CHECK(area == Approx((0.33 - edge) * (0.15 + 0.07)).epsilon(1e-6));
    }
}

TEST_CASE("a load that acts on nothing is refused by name") {
    LoadSpec spec = push(Side::top);
    spec.box = {{{"length", "0", "0"}, {"2*length", "0", "0"}}};
    try {
        with(upright(), spec);
        FAIL("it should be refused");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::scene);
        CHECK(std::string(error.what()).find("load push acts on nothing") != std::string::npos);
    }
}

TEST_CASE("a cavity is a closed surface, a part of one is not") {
    const Aggregate hollow =
        make_shape([](const Vec3& x) { return std::max(x.norm() - 0.75, 0.35 - x.norm()); },
                   Vec3::Constant(-0.8), Vec3i(16, 16, 16), 0.1);
    const auto inner = points_where(hollow, [](const Vec3& x) { return x.norm() < 0.5; });
    const auto outer = points_where(hollow, [](const Vec3& x) { return x.norm() > 0.5; });
    const auto half =
        points_where(hollow, [](const Vec3& x) { return x.norm() < 0.5 && x.x() > 0; });
    REQUIRE(half.size() > 20);
    CHECK(are_whole_surfaces(hollow, inner));
    CHECK(are_whole_surfaces(hollow, outer));
    CHECK_FALSE(are_whole_surfaces(hollow, half));
}

TEST_CASE(
    "inside are the walls of what is closed in, be it one cavity or two, and of nothing else") {
    const auto ball = [](const Vec3& x, const Vec3& at, double radius) {
        return (x - at).norm() - radius;
    };
    const Vec3 left(-0.7, 0, 0), right(0.6, 0.1, 0);
    const double wall = GENERATE(0.2, 0.45);  // two cells, and more
    const Aggregate hollow = make_shape(
        [&](const Vec3& x) {
            const double outer = std::min(ball(x, left, 0.6), ball(x, right, 0.75));
            return std::max({outer, -ball(x, left, 0.6 - wall), -ball(x, right, 0.75 - wall)});
        },
        Vec3(-1.4, -1, -1), Vec3i(28, 20, 20), 0.1);
    LoadSpec spec = push(Side::inside);
    spec.force.reset();
    spec.pressure = "2";
    const Machine machine = with(hollow, spec);
    const Load& load = machine.apparatus.load.at(0);
    CHECK(load.closed);
    CHECK(machine.load_on.at(0).size() == 2);
    const auto is_inside = [&](const Vec3& x) {
        return ball(x, left, 0.6 - 0.5 * wall) < 0 || ball(x, right, 0.75 - 0.5 * wall) < 0;
    };
    CHECK(load.point == points_where(hollow, is_inside));

    // A tube is open at its ends, a block has nothing in it.
    const Aggregate tube = make_shape(
        [](const Vec3& x) {
            const double r = std::hypot(x.x(), x.y());
            return std::max({r - 0.6, 0.3 - r, std::abs(x.z()) - 1});
        },
        Vec3(-0.8, -0.8, -1.2), Vec3i(16, 16, 24), 0.1);
    // A bowl too, though its rim is sharp: 40 degrees.
    const Aggregate bowl = make_shape(
        [&](const Vec3& x) {
            return std::max(ball(x, Vec3::Zero(), 0.7), -ball(x, Vec3(0, 0.5, 0), 0.75));
        },
        Vec3::Constant(-0.8), Vec3i(16, 16, 16), 0.1);
    for (const Aggregate& none : {tube, upright(), bowl}) {
        CHECK_THROWS_WITH(with(none, spec), Catch::Contains("load push acts on nothing: no part of "
                                                            "the work-piece's surface is the wall "
                                                            "of a closed cavity"));
    }
}

TEST_CASE("what of a surface looks to a side is told part by part, with how much and where it is") {
    // A U that is open upward, 1.6 long and 0.8 deep: the ends of its arms, and its floor.
    const Aggregate u = make_shape(
        [](const Vec3& x) {
            const double block = (x.cwiseAbs() - Vec3(0.8, 0.6, 0.4)).maxCoeff();
            return std::max(block, std::min(0.3 - std::abs(x.x()), x.y()));
        },
        Vec3(-1, -1, -1), Vec3i(20, 20, 20), 0.1);
    const Machine machine = with(u, push(Side::top));
    const std::vector<SurfaceComponent>& parts = machine.load_on.at(0);
    REQUIRE(parts.size() == 3);
    // What lies in its corners looks up or aside.
    CHECK(parts[0].area == Approx(0.6 * 0.8).epsilon(0.1));
    CHECK((parts[0].middle - Vec3(0, 0, 0)).norm() < 0.03);
    for (int arm : {1, 2}) {
        CHECK(parts[arm].area == Approx(0.5 * 0.8).epsilon(1e-4));
        CHECK((parts[arm].middle.cwiseAbs() - Vec3(0.55, 0.6, 0)).norm() < 1e-4);
    }
    CHECK(parts[1].middle.x() * parts[2].middle.x() < 0);
    LoadSpec arm = push(Side::top);
    arm.box = {{{"0.3*length", "-height", "-width"}, {"length", "height", "width"}}};
    const Machine boxed = with(u, arm);
    REQUIRE(boxed.load_on.at(0).size() == 1);
    CHECK(boxed.load_on[0][0].area == Approx((0.8 - 0.48) * 0.8).epsilon(1e-4));
}

TEST_CASE("a force spreads over what is stretched as that lies, and acts where it is said to") {
    Aggregate matter = upright();
    const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).matrix();
    deform(matter, [&](const Vec3& x) {  // its upper half is drawn out to three times its length
        return Vec3(turn * Vec3(x.x(), x.y() > 0 ? 3 * x.y() : x.y(), x.z()));
    });
    const Machine machine = with(matter, push(Side::top));
    const Load& load = machine.apparatus.load.at(0);
    Vec3 middle = Vec3::Zero(), sum = Vec3::Zero();
    double all = 0, drawn = 0;
    for (std::size_t n = 0; n < load.point.size(); ++n) {
        const std::size_t point = std::size_t(load.point[n]);
        const double force = load.force[n].norm();
        middle += force * matter.surface_position(point);
        if (matter.surface_reference(point).y() > 0) drawn += force;
        all += force;
        sum += load.force[n];
    }
    CHECK(sum.norm() == Approx(all));
    CHECK(drawn / all == Approx(0.75));  // of the area
    CHECK((middle / all - turn * Vec3(0, 0.4, 0.2)).norm() < 1e-6);
    REQUIRE(machine.load_on.at(0).size() == 1);
    CHECK(machine.load_on[0][0].area == Approx(1.6 * 0.3));
    CHECK((machine.load_on[0][0].middle - turn * Vec3(0, 0.4, 0.2)).norm() < 1e-6);
}

TEST_CASE("a side is what looks there now, not what did when it was molded") {
    Aggregate matter = upright();
    const auto rolled = [](const Vec3& x) { return Vec3(x.x(), -x.z(), x.y()); };  // about x
    deform(matter, [&](const Vec3& x) { return rolled(1.5 * x); });
    for (const auto& [side, normal] :
         {std::pair(Side::top, Vec3(Vec3::UnitY())), std::pair(Side::left, Vec3(-Vec3::UnitZ()))}) {
        LoadSpec spec = push(side);
        MachineSpec none;
        none.name = "none";
        none.load = {spec};
        const WorkFrame frame = place_work_frame(matter, WorldAxis::z, WorldAxis::y);
        const Load load = build_machine(none, {}, frame, matter).apparatus.load.at(0);
        CHECK_FALSE(load.point.empty());
        for (const int p : load.point) CHECK(rolled(matter.surface.normal(p)).dot(normal) == 1);
    }
}

TEST_CASE("of patches that a box cuts off, a force acts by what is left of each") {
    const Aggregate matter = upright();
    LoadSpec spec = push(Side::top);
    spec.box = {{{"-length", "-height", "-width"}, {"0.02", "height", "width"}}};
    const Load load = with(matter, spec).apparatus.load.at(0);
    REQUIRE(load.share.size() == load.point.size());
    double whole = 0, cut = 0;
    for (std::size_t n = 0; n < load.point.size(); ++n) {
        const bool is_cut = load.share[n] < 0.99;
        CHECK(load.share[n] == Approx(is_cut ? 0.4 : 1).epsilon(1e-4));  // 2 of 5 cm
        (is_cut ? cut : whole) += load.force[n].norm() / load.share[n];
    }
    CHECK(cut / whole == Approx(1.0 / 8).epsilon(1e-4));  // as many of 2 * 4 more before it
}

TEST_CASE("a patch beside a cut has the area that its side has now") {
    Aggregate matter = upright();
    sever_plane(matter, Vec3(0, 0.05, 0), Vec3::UnitY());
    deform(matter, [](const Vec3& x) { return Vec3(3 * x.x(), 3 * x.y(), 3 * x.z()); });
    std::size_t parted = 0;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        const bool is_parted = !cell_is_whole(matter, matter.surface.row(p));
        parted += is_parted;
        CHECK(patch_area(matter, p) == Approx(9 * matter.surface.area(p)).epsilon(1e-6));
    }
    CHECK(parted > 0);
    CHECK(parted < matter.surface.size());
}

TEST_CASE("what lies beside a cut is found where its own side has gone") {
    Aggregate matter = upright();
    sever_plane(matter, Vec3(0, 0.08, 0), Vec3::UnitY());
    const Vec3 away(0.1, 1, 0);
    const auto gone = [&](const Vec3& x, double cut) { return x.y() > cut ? away : Vec3(0, 0, 0); };
    deform(matter, [&](const Vec3& x) { return Vec3(x + gone(x, 0.08)); });
    const std::vector<Vec3> at = surface_positions(matter);
    for (std::size_t p = 0; p < at.size(); ++p) {
        const Vec3 x = matter.surface_reference(p);
        CHECK((at[p] - x - gone(x, 0.08)).norm() < 1e-6);
    }
    const SurfacePart top = find_region(matter, Pose{}, at, Side::front, nullptr);
    for (int p : top.point) CHECK(matter.surface.normal(std::size_t(p)).z() == 1);
}

TEST_CASE("a pressure whose box cuts patches off a surface does not press it all round") {
    const Aggregate ball = make_shape([](const Vec3& x) { return x.norm() - 0.75; },
                                      Vec3::Constant(-0.8), Vec3i(16, 16, 16), 0.1);
    const auto gas_up_to = [&](const char* end) {
        LoadSpec gas;
        gas.name = "gas";
        gas.pressure = "1000";
        gas.box = {{{"-length", "-height", "-width"}, {end, "height", "width"}}};
        return with(ball, gas).apparatus.load.at(0);
    };
    CHECK(gas_up_to("length").closed);
    const Load cut = gas_up_to("0.499*length");
    CHECK(cut.point.size() == ball.surface.size());  // something of each patch
    CHECK_FALSE(cut.share.empty());
    CHECK_FALSE(cut.closed);
}
