// SPDX-License-Identifier: GPL-3.0-or-later
// The machine files that swage ships do what they say (S2.13 to S2.15).
#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "geometry/make_shape.h"
#include "machines/legs.h"
#include "machines/parameters.h"
#include "machines/touch.h"
#include "mold/mold.h"
#include "sim/sever.h"
#include "tests/scene/shipped_machines.h"
#include "tests/shared/block.h"

using namespace swage;
using test::at_bar;
using test::index_of;
using test::kMachines;

namespace {

using Given = std::map<std::string, double>;

// Of the pose since the start, about the world's z axis.
double turned(const Pose& start, const Pose& now) {
    const Vec3 x = (now.rotation * start.rotation.conjugate()) * Vec3::UnitX();
    return std::atan2(x.y(), x.x());
}

}  // namespace

TEST_CASE("every shipped machine can be read, and stands at its work-piece without a doubt") {
    const std::set<std::string> for_sheets = {"draw"};
    const Aggregate usual = bar(),
                    sheet = body_of(
                        box_points({-0.1, -0.002, -0.1}, {0.1, 0.002, 0.1}, {40, 2, 40}), 0.002);
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kMachines)) {
        INFO(entry.path());
        const std::string name = entry.path().stem().string();
        const Machine machine = at_bar(name, {}, for_sheets.contains(name) ? sheet : usual);
        for (const std::string& note : machine.notes) FAIL_CHECK(note);
        CHECK_FALSE(machine.spec.help.empty());
        for (const ParameterSpec& parameter : machine.spec.parameter) {
            CHECK_FALSE(parameter.help.empty());
            CHECK_FALSE(parameter.low.empty());
            CHECK_FALSE(parameter.high.empty());
        }
        ++count;
    }
    CHECK(count >= 3);
}

TEST_CASE("every shipped machine's defaults suit a cube of few cells and of many") {
    const std::vector<Vec3> points = box_points({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, {12, 12, 12});
    for (const auto& entry : std::filesystem::directory_iterator(kMachines)) {
        for (const double cells : {3.0, 4.0, 6.0, 9.0, 20.0}) {
            INFO(entry.path() << ", " << cells << " cells");
            const Machine machine =
                at_bar(entry.path().stem().string(), {}, body_of(points, 1 / cells));
            for (const std::string& note : machine.notes) {
                CHECK(note.find("overlap") == std::string::npos);
            }
        }
    }
}

TEST_CASE("every shipped machine stands with its defaults at boxes of any proportions") {
    const auto along = [](int axis, double longer, double shorter, bool flat) {
        Vec3 size = Vec3::Constant(flat ? longer : shorter);
        size[axis] = flat ? shorter : longer;
        return size;
    };
    std::vector<std::pair<std::string, Aggregate>> bodies;
    constexpr int kAxis = 1;  // machines stand at them along each axis
    for (const int layers : {1, 2}) {
        const auto cells = [&](double longer, bool flat) {
            const Vec3 n = along(kAxis, longer, layers, flat);
            bodies.emplace_back(
                fmt::format("{} by {} by {} cells", n.x(), n.y(), n.z()),
                test::make_block(int(n.x()), int(n.y()), int(n.z()), 0.01, Material{}));
        };
        cells(16, true);
        cells(120, false);
    }
    // Thinner than its cells.
    for (const bool flat : {true, false}) {
        const Vec3 half = along(kAxis, 0.5, 0.001, flat);
        const Vec3i divisions = along(kAxis, flat ? 40 : 100, 8, flat).cast<int>();
        bodies.emplace_back(fmt::format("thin {}", flat ? "sheet" : "needle"),
                            body_of(box_points(-half, half, divisions), flat ? 0.05 : 0.02));
    }
    const WorldAxis axes[] = {WorldAxis::x, WorldAxis::y, WorldAxis::z};
    for (const auto& entry : std::filesystem::directory_iterator(kMachines)) {
        const MachineSpec spec = test::shipped_machine(entry.path().stem().string());
        for (const auto& [name, body] : bodies) {
            for (const WorldAxis axis : axes) {
                for (const WorldAxis up : axes) {
                    if (up == axis) continue;
                    INFO(spec.name << " at " << name << ", axis " << name_of(axis) << ", up "
                                   << name_of(up));
                    const WorkFrame frame = place_work_frame(body, axis, up);
                    // Jaws that are narrower than a cell pass between its points.
                    if (spec.name == "wring" && frame.size.x() < 3 * body.lattice.spacing) {
                        CHECK_NOTHROW(
                            resolve_parameters(spec, {}, work_piece_variables(body, frame)));
                        continue;
                    }
                    CHECK_NOTHROW(build_machine(spec, {}, frame, body));
                }
            }
        }
    }
}

TEST_CASE("the bender's pushers turn about the support by half the angle each, and open again") {
    for (const double angle : {0.3, kPi / 3, kPi}) {
        for (const double place : {-0.1, 0.0, 0.2}) {
            const double radius = 0.07, pusher_radius = 0.03, overhang = 0.15, clearance = 0.04;
            const Machine machine = at_bar("bend", {{"angle", angle},
                                                    {"radius", radius},
                                                    {"pusher_radius", pusher_radius},
                                                    {"overhang", overhang},
                                                    {"place", place},
                                                    {"clearance", clearance},
                                                    {"press", 0.5},
                                                    {"hold", 0.1},
                                                    {"release", 0.3}});
            const int support = index_of(machine.apparatus.tool, "support");
            const Drive start = drive_at(machine, 0, 1);
            const Vec3 axis = start.world_from_tool[support].translation;
            CHECK((axis - Vec3(place, -0.05 - radius, 0)).norm() < 1e-8);
            for (const int side : {-1, 1}) {
                const int pusher = index_of(machine.apparatus.tool, side < 0 ? "left" : "right");
                const Pose from = start.world_from_tool[pusher];
                CHECK((from.translation - Vec3(place + side * overhang, 0.05 + pusher_radius, 0))
                          .norm() < 1e-8);
                for (const double t : {0.5, 0.55, 0.6}) {
                    const Drive pressed = drive_at(machine, t, 1);
                    const Pose to = pressed.world_from_tool[pusher];
                    CHECK(turned(from, to) == Approx(-side * angle / 2));
                    const Vec3 arm = Eigen::AngleAxisd(-side * angle / 2, Vec3::UnitZ()) *
                                     (from.translation - axis);
                    CHECK((to.translation - axis - arm).norm() < 1e-12);
                    CHECK((pressed.world_from_tool[support].translation - axis).norm() == 0);
                }
                const Pose half = drive_at(machine, 0.25, 1).world_from_tool[pusher];
                CHECK(turned(from, half) == Approx(-side * angle / 4));
                const Pose back = drive_at(machine, 0.9, 1).world_from_tool[pusher];
                CHECK((back.translation - from.translation).norm() < 1e-12);
                const Pose open = drive_at(machine, 1, 1).world_from_tool[pusher];
                CHECK((open.translation - from.translation - Vec3(0, clearance, 0)).norm() < 1e-12);
            }
        }
    }
}

TEST_CASE("a bender that does not release keeps its pushers where they are to the end") {
    for (const double press : {0.6, 1.0}) {
        const Machine machine = at_bar("bend", {{"press", press}, {"hold", 0}, {"release", 0}});
        const Drive pressed = drive_at(machine, press, 1), end = drive_at(machine, 1, 1);
        for (std::size_t n = 0; n < end.world_from_tool.size(); ++n) {
            CHECK((pressed.world_from_tool[n].translation - end.world_from_tool[n].translation)
                      .norm() < 1e-12);
        }
    }
}

TEST_CASE("the bender warns of a work-piece that would slip out, by where its tools stand") {
    CHECK(at_bar("bend", {{"overhang", 0.3}, {"angle", 2.0}, {"radius", 0.12}}).notes.empty());
    CHECK(at_bar("bend", {{"overhang", 0.4}, {"angle", 2.0}, {"radius", 0.12}}).notes.size() == 1);
    CHECK(at_bar("bend", {{"overhang", 0.05}, {"pusher_radius", 0.03}}).notes.size() == 1);
    for (const double degrees : {30.0, 90.0, 135.0, 180.0}) {
        CHECK(at_bar("bend", {{"angle", degrees * kPi / 180}}).notes.empty());
    }
}

TEST_CASE("the bender's tools follow the body's outline, not its box") {
    // A bar with a tall block on its left half.
    std::vector<Vec3> points = box_points({-0.5, -0.05, -0.05}, {0.5, 0.05, 0.05}, {80, 8, 8});
    const auto block = box_points({-0.5, 0.05, -0.05}, {-0.2, 0.15, 0.05}, {24, 8, 8});
    points.insert(points.end(), block.begin(), block.end());
    const Machine machine =
        at_bar("bend", {{"pusher_radius", 0.03}, {"overhang", 0.3}}, body_of(points, 0.0125));
    const Drive start = drive_at(machine, 0, 1);
    const auto height = [&](const char* tool) {
        return start.world_from_tool[index_of(machine.apparatus.tool, tool)].translation.y();
    };
    CHECK(height("left") == Approx(0.15 + 0.03).margin(1e-8));
    CHECK(height("right") == Approx(0.05 + 0.03).margin(1e-8));
}

TEST_CASE("the twister's second grip turns by the angle about the bar, the first one stays") {
    const Aggregate body = bar(2, {1, 2, 3});
    for (const double angle : {-1.0, kPi / 2, 7.5 * kPi}) {
        const Machine machine = at_bar("twist", {{"angle", angle}, {"lift", 0.02}}, body);
        const Drive end = drive_at(machine, 1, 1);
        const Pose& world_from_work = machine.frame.world_from_work;
        for (int g = 0; g < 2; ++g) {
            const Grip& grip = machine.apparatus.grip[g];
            REQUIRE(grip.point.size() > 200);
            for (std::size_t n = 0; n < grip.point.size(); n += 7) {
                const Vec3 from = world_from_work.inverse() * body.surface_position(grip.point[n]);
                const Vec3 to =
                    world_from_work.inverse() * (end.world_from_grip[g] * grip.anchor[n]);
                const Vec3 pivot(0, 0.02, 0);
                const Vec3 wanted =
                    g == 0 ? from
                           : Vec3(pivot + Eigen::AngleAxisd(angle, Vec3::UnitX()) * (from - pivot));
                CHECK((to - wanted).norm() < 1e-11);
                CHECK(std::abs(from.x()) >= 0.38 - 0.25 * body.lattice.spacing);
                CHECK((from.x() > 0) == (g == 1));
            }
        }
    }
}

TEST_CASE("the twister's grips leave the free part free, wherever it lies") {
    const Aggregate body = bar();
    const Machine machine =
        at_bar("twist", {{"grip_length", 0.1}, {"free", 0.3}, {"place", 0.15}}, body);
    const std::array<std::array<double, 2>, 2> wanted = {{{-0.1, 0.0}, {0.3, 0.4}}};
    for (int g = 0; g < 2; ++g) {
        Box held;
        for (int p : machine.apparatus.grip[g].point) held.grow(body.surface_position(p));
        CHECK(held.low.x() == Approx(wanted[g][0]).margin(0.0126));
        CHECK(held.high.x() == Approx(wanted[g][1]).margin(0.0126));
    }
}

TEST_CASE("the cutter's edge sweeps the whole section, in one plane through its place") {
    for (const double tilt : {-0.6, 0.0, 0.4}) {
        for (const double rake : {-0.3, 0.0, 0.09}) {
            const double place = 0.1, cutting = 0.7;
            const Machine machine = at_bar(
                "cut", {{"tilt", tilt}, {"rake", rake}, {"place", place}, {"cutting", cutting}});
            CHECK(machine.notes.empty());
            const Vec3 way(std::sin(tilt), -std::cos(tilt), 0);
            const Vec3 normal(std::cos(tilt), std::sin(tilt), 0);
            const std::vector<Vec3>& edge = machine.apparatus.blade[0].edge;
            // How far along its way the edge is at the height z across, relative to the place.
            const auto reached = [&](double t, double z) {
                const Pose pose = drive_at(machine, t, 1).world_from_blade[0];
                const Vec3 a = pose * edge[0], b = pose * edge[1];
                CHECK(std::abs(normal.dot(a - Vec3(place, 0, 0))) < 1e-12);
                CHECK(std::abs(normal.dot(b - Vec3(place, 0, 0))) < 1e-12);
                CHECK(a.z() < -0.05);
                CHECK(b.z() > 0.05);
                const double share = (z - a.z()) / (b.z() - a.z());
                return way.dot((1 - share) * a + share * b - Vec3(place, 0, 0));
            };
            const double section = 0.05 / std::cos(tilt);  // half of its height, in the plane
            for (const double z : {-0.05, 0.0, 0.05}) {
                CHECK(reached(0, z) < -section);
                CHECK(reached(cutting, z) > section);
                CHECK(reached(cutting + 0.1, z) == Approx(reached(0, z)));  // up again
                CHECK(reached(1, z) == Approx(reached(0, z)));
                CHECK(reached(0.3, z) > reached(0.2, z));
            }
            // The piece is drawn away only when it is free.
            const Pose start = drive_at(machine, 0, 1).world_from_grip[1];
            CHECK((drive_at(machine, cutting, 1).world_from_grip[1].translation - start.translation)
                      .norm() < 1e-12);
            CHECK((drive_at(machine, 1, 1).world_from_grip[1].translation - start.translation -
                   Vec3(0.15, 0, 0))
                      .norm() < 1e-12);
        }
    }
}

TEST_CASE("the cutter parts a rod however its cells lie in it, and however they stick out") {
    const TriMesh rod = make_shape("rod", {{"length", 1.0}, {"diameter", 0.1}}).mesh;
    for (int across : {1, 3, 4}) {
        MoldSettings settings;
        settings.across = across;
        const Aggregate molded = mold(rod, Material{}, settings);
        for (double turned : {0.0, 0.3, 0.65}) {
            Aggregate body = molded;
            const Eigen::AngleAxisd turn(turned, Vec3::UnitX());
            for (std::size_t p = 0; p < body.particle_count(); ++p) {
                body.particle_position.set(p, turn * body.particle_position.at(p));
            }
            const Machine machine = at_bar("cut", {}, body);
            const std::vector<Drive> way =
                drives_of(machine, legs_of(machine, 40, 1, false).leg, 1, 1);
            sever(body, crossed_connections(body, swept_triangles(machine.apparatus, way)));
            CHECK(find_pieces(body).count == 2);
        }
    }
}

TEST_CASE("the cutter's blade stays down where it is asked to") {
    const Machine machine = at_bar("cut", {{"rising", 0}});
    const auto height = [&](double t) {
        return drive_at(machine, t, 1).world_from_blade[0].translation.y();
    };
    CHECK(height(0.6) < height(0) - 0.1);
    CHECK(height(1) == Approx(height(0.6)));
}

TEST_CASE("a machine that is asked for nothing of what it is for tells so") {
    const auto told = [](const std::string& name, const Given& given) {
        const std::vector<std::string> notes = at_bar(name, given).notes;
        return std::count_if(notes.begin(), notes.end(), [](const std::string& note) {
            return note.find(" is 0: ") != std::string::npos;
        });
    };
    CHECK(told("bend", {{"angle", 0}}) == 1);
    CHECK(told("twist", {{"angle", 0}}) == 1);
    CHECK(told("twist", {{"angle", 0}, {"stretch", 0.1}}) == 0);
    CHECK(told("press", {{"depth", 0}}) == 1);
    CHECK(told("stretch", {{"strain", 0}}) == 1);
    for (const char* name : {"bend", "twist", "press", "stretch"}) CHECK(told(name, {}) == 0);
}

TEST_CASE("the cutter warns of a cut that runs into a grip") {
    CHECK(at_bar("cut", {{"place", 0.36}, {"tilt", 0.5}}).notes.size() == 1);
}

TEST_CASE("the slicer parts a rod into slices of one thickness, together or in turn") {
    const TriMesh rod = make_shape("rod", {{"length", 1.0}, {"diameter", 0.1}}).mesh;
    MoldSettings settings;
    settings.across = 3;
    const Aggregate molded = mold(rod, Material{}, settings);
    for (const double slices : {2.0, 3.0, 7.0}) {
        for (const double in_turn : {0.0, 0.6, 1.0}) {
            Aggregate body = molded;
            const Machine machine =
                at_bar("slice", {{"slices", slices}, {"in_turn", in_turn}, {"gap", 0.02}}, body);
            CHECK(machine.notes.empty());
            REQUIRE(machine.apparatus.blade.size() == slices - 1);
            const std::vector<Drive> way =
                drives_of(machine, legs_of(machine, 40, 1, false).leg, 1, 1);
            sever(body, crossed_connections(body, swept_triangles(machine.apparatus, way)));
            CHECK(find_pieces(body).count == slices);
            // The middles of the slices are even, before and after.
            const Drive start = drive_at(machine, 0, 1), end = drive_at(machine, 1, 1);
            const Drive open = drive_at(machine, 0.6 + machine.parameter.at("rising"), 1);
            for (std::size_t n = 0; n < machine.apparatus.blade.size(); ++n) {
                const Vec3 risen = open.world_from_blade[n].translation;
                CHECK((risen - start.world_from_blade[n].translation).norm() < 1e-12);
            }
            for (std::size_t n = 0; n < machine.apparatus.grip.size(); ++n) {
                // No slice moves while a blade stands in its way.
                CHECK((open.world_from_grip[n].translation - start.world_from_grip[n].translation)
                          .norm() < 1e-12);
                const double middle = double(n) - 0.5 * (slices - 1);
                const double before = start.world_from_grip[n].translation.x();
                CHECK(std::abs(before - middle / slices) <= 0.5 * body.lattice.spacing);
                CHECK(end.world_from_grip[n].translation.x() - before ==
                      Approx(0.02 * middle).margin(1e-12));
            }
            // In turn: the first is down when the last has not begun.
            const auto fallen = [&](std::size_t blade, double t) {
                return start.world_from_blade[blade].translation.y() -
                       drive_at(machine, t, 1).world_from_blade[blade].translation.y();
            };
            const std::size_t last = machine.apparatus.blade.size() - 1;
            if (in_turn == 1 && last > 0) {
                CHECK(fallen(0, 0.6 / (slices - 1)) == Approx(fallen(last, 0.6)));
                CHECK(fallen(last, 0.6 * (slices - 2) / (slices - 1)) == Approx(0).margin(1e-12));
            }
            if (in_turn == 0) CHECK(fallen(0, 0.3) == Approx(fallen(last, 0.3)));
        }
    }
}

TEST_CASE("the stretcher draws by the strain of the free part, and returns if asked to") {
    const Machine machine = at_bar(
        "stretch", {{"strain", 0.5}, {"grip_length", 0.1}, {"drawing", 0.5}, {"release", 0.25}});
    const auto drawn = [&](double t) {
        return (drive_at(machine, t, 1).world_from_grip[1].translation -
                drive_at(machine, 0, 1).world_from_grip[1].translation)
            .x();
    };
    CHECK(drawn(0.5) == Approx(0.5 * 0.8));
    CHECK(drawn(0.7) == Approx(0.5 * 0.8));
    CHECK(drawn(1) == Approx(0).margin(1e-12));
}

TEST_CASE("the press leaves the part of the height it says between its plates") {
    const Machine machine = at_bar("press", {{"depth", 0.3}, {"press", 0.5}, {"release", 0.25}});
    const int anvil = index_of(machine.apparatus.tool, "anvil");
    const int plate = index_of(machine.apparatus.tool, "plate");
    const double thick = bounds_of(machine.apparatus.tool[plate].shape).size().y();
    const auto between_plates = [&](double t) {
        const Drive drive = drive_at(machine, t, 1);
        return drive.world_from_tool[plate].translation.y() -
               drive.world_from_tool[anvil].translation.y() - thick;
    };
    CHECK(between_plates(0) == Approx(0.1).margin(1e-8));
    CHECK(between_plates(0.5) == Approx(0.07).margin(1e-8));
    CHECK(between_plates(0.75) == Approx(0.07).margin(1e-8));
    CHECK(between_plates(1) == Approx(0.12).margin(1e-8));
}

TEST_CASE("the jaws of the wringer press in at first, turn with the bar and open at the end") {
    const Aggregate body = bar();
    const double squeeze = 0.002, angle = 1.1;
    const Machine machine =
        at_bar("wring", {{"squeeze", squeeze}, {"angle", angle}, {"clearance", 0.03}}, body);
    REQUIRE(machine.apparatus.tool.size() == 8);
    // The bar as it would be if it were rigid and its right half turned with the jaws.
    std::vector<Vec3> turned_bar = surface_positions(body);
    const Eigen::AngleAxisd turn(angle, Vec3::UnitX());
    for (Vec3& p : turned_bar) p = p.x() > 0 ? Vec3(turn * p) : p;
    for (std::size_t n = 0; n < 8; ++n) {
        const Shape& jaw = machine.apparatus.tool[n].shape;
        CHECK(nearest_distance(jaw, drive_at(machine, 0, 1).world_from_tool[n],
                               surface_positions(body)) == Approx(-squeeze).margin(1e-8));
        CHECK(nearest_distance(jaw, drive_at(machine, 0.8, 1).world_from_tool[n], turned_bar) ==
              Approx(-squeeze).margin(1e-8));
        CHECK(nearest_distance(jaw, drive_at(machine, 1, 1).world_from_tool[n], turned_bar) ==
              Approx(0.03 - squeeze).margin(1e-8));
    }
}

TEST_CASE("the bender's pushers stand on the bar wherever its support does") {
    for (const double place : {-0.4, -0.35, 0.0, 0.3, 0.4}) {
        const Machine machine = at_bar("bend", {{"place", place}});
        for (const Pose& tool : machine.work_from_tool) {
            INFO(place << ": " << tool.translation.x());
            CHECK(std::abs(tool.translation.x()) <= 0.5 + 1e-9);
        }
    }
}

TEST_CASE("a machine that stops does so without a jump, and what presses comes no farther") {
    struct Case {
        const char *machine, *part;
        Given given;
        double release;  // share of the stage from which it draws back
    };
    const Case cases[] = {{"press", "plate", {}, 0.65},
                          {"bend", "left", {}, 0.65},
                          {"bend", "right", {}, 0.65},
                          {"stretch", "draw", {{"drawing", 0.6}, {"release", 0.3}}, 0.7},
                          {"twist", "turn", {}, 1},
                          {"wring", "turn_above", {}, 0.85}};
    for (const auto& [name, part, given, release] : cases) {
        Machine machine = at_bar(name, given);
        CHECK(machine.spec.stops);
        const auto pose = [&](double t, double stop) {
            machine.stop = stop;
            const Drive drive = drive_at(machine, t, 1);
            for (std::size_t n = 0; n < machine.apparatus.tool.size(); ++n) {
                if (machine.apparatus.tool[n].name == part) return drive.world_from_tool[n];
            }
            return drive.world_from_grip[1];
        };
        const auto apart = [](const Pose& a, const Pose& b) {
            return (a.translation - b.translation).norm() + turn_between(a, b).norm();
        };
        for (const double stop : {0.0, 0.2, 0.45, 0.59}) {
            INFO(name << " " << part << " " << stop);
            const Pose there = pose(stop, 1);
            CHECK(apart(pose(stop, stop), there) == 0);
            CHECK(apart(pose(0.5 * (stop + release), stop), there) == 0);
            CHECK(apart(pose(release, stop), there) < 1e-12);
            // It draws back to where it does anyway; jaws open across what they have turned.
            if (release == 1 || std::string(name) == "wring") continue;
            CHECK(apart(pose(1, stop), pose(1, 1)) < 1e-12);
        }
    }
    CHECK_FALSE(test::shipped_machine("hold").stops);
    CHECK_FALSE(test::shipped_machine("cut").stops);
}
