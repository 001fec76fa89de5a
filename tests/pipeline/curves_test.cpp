// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/curves.h"

#include <algorithm>
#include <limits>

#include "base/text.h"
#include "tests/catch.h"
#include "tests/pipeline/part_curves.h"

using namespace swage;

namespace {

Pose turned(double angle) { return {Quat(Eigen::AngleAxisd(angle, Vec3::UnitX())), Vec3::Zero()}; }

StageCurves turning_grip(int frames, double total) {
    StageCurves curves =
        test::part_curves("1-twist", 1, {{"holder", Pose{}}, {"turner, left", Pose{}}});
    for (int f = 1; f <= frames; ++f) {
        FrameReport report;
        report.time = 0.1 * f;
        report.load.resize(2);
        report.load[1].pose = turned(total * f / frames);
        report.load[1].torque = {0.25, 0, 0};
        report.work = 2.0 * f;
        curves.add(1 + f, report);
    }
    return curves;
}

}  // namespace

TEST_CASE(
    "a part's torque about the axis that it turns about goes with the part, signed as its turn") {
    // About -z through (0, -2, 0) in the world, which a part at (3, 0, 0) on its side has
    // elsewhere.
    const Pose start{Quat(Eigen::AngleAxisd(kPi / 2, Vec3::UnitX())), Vec3(3, 0, 0)};
    const TurnAxis axis{start.inverse().turn(-Vec3::UnitZ()), start.inverse() * Vec3(0, -2, 0)};
    StageCurves curves("s", 1, {{"arm", start}, {"anvil", Pose{}}}, {}, 2, {axis, std::nullopt},
                       {});
    const Vec3 force(0, 5, 1), torque(0.5, 0, 0.25);
    FrameReport report;
    report.load = {{"arm", start}, {"anvil", Pose{}}};
    report.load[0].force = force, report.load[0].torque = torque;
    curves.add(2, report);
    const Quat turn(Eigen::AngleAxisd(0.7, Vec3::UnitZ()));  // all of it, about that axis
    const Pose about{turn, Vec3(0, -2, 0) - turn * Vec3(0, -2, 0)};
    report.load[0].pose = about * start;
    report.load[0].force = turn * force, report.load[0].torque = turn * torque;
    curves.add(3, report);
    REQUIRE(curves.load()[0].axial_torque.size() == 3);
    CHECK(curves.load()[0].axial_torque[1] == Approx(0.25 + 3 * 5));  // x F_y - y F_x, about +z
    CHECK(curves.load()[0].axial_torque[2] == Approx(0.25 + 3 * 5));
    CHECK(csv_text(curves).find("arm torque about its axis [N m]") != std::string::npos);
    CHECK(csv_text(curves).find("anvil torque about") == std::string::npos);
    const std::vector<std::string> lines = lines_of(csv_text(curves));
    const auto cells = [](const std::string& line) {
        return std::count(line.begin(), line.end(), ',');
    };
    for (const std::string& line : lines) CHECK(cells(line) == cells(lines.front()));
}

TEST_CASE("a turn is followed past half a turn and past a whole one") {
    for (double total : {0.3, -0.3, 5.0, -5.0, 15.0}) {
        const StageCurves curves = turning_grip(20, total);
        CHECK(curves.load()[1].turn.back() == Approx(total));
    }
    CHECK(turning_grip(20, 5.0).load()[0].turn.back() == 0);
}

TEST_CASE("a turn by more than half a round within a frame is followed by its legs") {
    StageCurves curves = test::part_curves("s", 1, {{"turner", Pose{}}});
    FrameReport report;
    report.load.resize(1);
    for (double angle : {1.2, 2.4, 3.6, 4.8}) {
        report.load[0].pose = turned(angle);
        curves.pass(report.load);
    }
    curves.add(2, report);
    REQUIRE(curves.rows() == 2);
    CHECK(curves.load()[0].turn.back() == Approx(4.8));
}

TEST_CASE("a turn there and back ends at nothing") {
    StageCurves curves = test::part_curves("s", 1, {{"turner", Pose{}}});
    for (double angle : {0.5, 1.0, 0.5, 0.0}) {
        FrameReport report;
        report.load.resize(1);
        report.load[0].pose = turned(angle);
        curves.add(2, report);
    }
    CHECK(curves.load()[0].turn[2] == Approx(1.0));
    CHECK(curves.load()[0].turn.back() == Approx(0.0).margin(1e-12));
}

TEST_CASE("the table has one row a frame and as many cells as columns") {
    const std::vector<std::string> lines = lines_of(csv_text(turning_grip(4, 1.0)));
    REQUIRE(lines.size() == 1 + 5);
    // The name with a comma stands in quotes: two commas are inside each of its 14 headings.
    const auto commas = [](const std::string& line) {
        return std::count(line.begin(), line.end(), ',');
    };
    CHECK(commas(lines[0]) - 14 == commas(lines[1]));
    for (std::size_t row = 2; row < lines.size(); ++row)
        CHECK(commas(lines[row]) == commas(lines[1]));
    CHECK(lines[0].rfind("frame,time [s],holder x [m]", 0) == 0);
    CHECK(lines[1].rfind("1,0,", 0) == 0);
    CHECK(lines[5].rfind("5,0.4,", 0) == 0);
}

TEST_CASE("no two columns of the table have one name, under gravity too") {
    const StageCurves curves =
        test::part_curves("1-floor", 1, {{"holder", Pose{}}, {"gravity", Pose{}}});
    std::string heads = lines_of(csv_text(curves)).front();
    std::replace(heads.begin(), heads.end(), ',', '\n');
    std::vector<std::string> names = lines_of(heads);
    CHECK(std::count(names.begin(), names.end(), "gravity work [J]") == 1);
    CHECK(std::count(names.begin(), names.end(), "gravity travel [m]") == 1);
    std::sort(names.begin(), names.end());
    CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
}

TEST_CASE("loads are plotted against what moves most") {
    const PlotAxis turn = plot_axis(turning_grip(10, 2.0));
    CHECK(turn.label == "turn of turner, left [deg]");
    CHECK(turn.value.back() == Approx(2.0 * 180 / kPi));
    CHECK(plot_axis(turning_grip(10, 0.0)).label == "time [s]");

    StageCurves press = test::part_curves("2-press", 1, {{"ram", Pose{}}});
    FrameReport report;
    report.load.resize(1);
    report.load[0].pose.translation = {0, -0.02, 0};
    press.add(2, report);
    const PlotAxis travel = plot_axis(press);
    CHECK(travel.label == "stroke of ram [mm]");
    CHECK(travel.value.back() == Approx(20.0));

    // What falls takes gravity with it, which is driven nowhere.
    StageCurves fall("3-floor", 1, {{"floor", Pose{}}, {"gravity", Pose{}}}, {}, 1, {}, {});
    report.load = {{"floor", Pose{}}, {"gravity", {Quat::Identity(), {0, -0.02, 0}}}};
    fall.add(2, report);
    CHECK(plot_axis(fall).label == "time [s]");
}

namespace {

StageCurves going(const std::vector<Pose>& way) {
    StageCurves curves = test::part_curves("s", 1, {{"ram", way.front()}});
    for (std::size_t n = 1; n < way.size(); ++n) {
        FrameReport report;
        report.load.resize(1);
        report.load[0].pose = way[n];
        curves.add(1 + int(n), report);
    }
    return curves;
}

}  // namespace

TEST_CASE("what comes back on its way comes back in the plot, and beyond its start") {
    std::vector<Pose> press;
    for (double down : {0.0, 2e-3, 4.4e-3, 2e-3, -2.2e-3}) {
        press.push_back({Quat::Identity(), Vec3(0.3, 1 - down, 1e-2 * down)});
    }
    const PlotAxis stroke = plot_axis(going(press));
    CHECK(stroke.label == "stroke of ram [mm]");
    const double expected[] = {0, 2, 4.4, 2, -2.2};
    for (int n = 0; n < 5; ++n) CHECK(stroke.value[n] == Approx(expected[n]).epsilon(1e-3));

    std::vector<Pose> circle;
    for (int n = 0; n <= 16; ++n) {
        circle.push_back(
            {Quat::Identity(), turn_about(Vec3::UnitZ(), n * kPi / 8) * Vec3(0, 1, 0)});
    }
    const PlotAxis travel = plot_axis(going(circle));
    CHECK(travel.label == "travel of ram [mm]");
    CHECK(travel.value.back() > 6e3);

    std::vector<Pose> wrench;
    for (double angle : {0.0, -1.0, -2.0, -1.0, 0.0}) wrench.push_back(turned(angle));
    const PlotAxis turn = plot_axis(going(wrench));
    CHECK(turn.label == "turn of ram [deg]");
    CHECK(turn.value[2] == Approx(2 * 180 / kPi));
    CHECK(turn.value.back() == Approx(0).margin(1e-9));
}

TEST_CASE("the way of a load leaves out what its place jumps by as it acts on something else") {
    const auto at = [](const Vec3& place, const Vec3& jump) {
        return ToolLoad{"push", {Quat::Identity(), place}, jump};
    };
    StageCurves curves = test::part_curves("s", 1, {at({1, 0, 0}, {0, 0, 0})});
    FrameReport report;
    report.load = {at({1, -0.1, 0}, {0, 0, 0})};
    curves.add(2, report);
    curves.pass({at({0.5, -0.2, 0}, {-0.5, 0, 0})});
    report.load = {at({0.5, -0.3, 0}, {-0.5, 0, 0})};
    curves.add(3, report);
    const LoadCurve& push = curves.load()[0];
    CHECK(push.pose[2].translation == Vec3(0.5, -0.3, 0));
    CHECK(push.travel[1] == Approx(0.1));
    CHECK(push.travel[2] == Approx(0.3));
    CHECK(stroke_of(push).at(2) == Approx(0.3));
    CHECK(peaks_of(curves)[0].stroke == Approx(0.3));
}

TEST_CASE("a press that rises farther than it went down has gone the way down") {
    StageCurves curves = test::part_curves("s", 1, {{"plate", Pose{}}, {"idle", Pose{}}});
    const double heights[] = {-1, -3, -2, 5}, forces[] = {2, 9, 4, 0};
    for (int n = 0; n < 4; ++n) {
        FrameReport report;
        report.load.resize(2);
        report.load[0].force = {0, forces[n], 0};
        for (ToolLoad& load : report.load) load.pose.translation = {0, 1e-3 * heights[n], 0};
        curves.add(2 + n, report);
    }
    const std::vector<double> down = stroke_of(curves.load()[0]);
    const double expected[] = {0, 1e-3, 3e-3, 2e-3, -5e-3};
    REQUIRE(down.size() == 5);
    for (int n = 0; n < 5; ++n) CHECK(down[n] == Approx(expected[n]));
    CHECK(peaks_of(curves)[0].stroke == Approx(3e-3));
    CHECK(peaks_of(curves)[1].stroke == Approx(5e-3));  // it bears nothing anywhere
}

TEST_CASE("peaks are the most that was felt, in the frame it was, and the farthest way") {
    StageCurves curves = test::part_curves("s", 7, {{"ram", Pose{}}, {"idle", Pose{}}});
    const double forces[] = {3, -8, 8, 1}, torques[] = {0.5, 0.25, -1, 0}, ways[] = {1, 4, 2, -3};
    for (int n = 0; n < 4; ++n) {
        FrameReport report;
        report.load.resize(2);
        report.load[0].force = {0, forces[n], 0};
        report.load[0].torque = {0, 0, torques[n]};
        report.load[0].pose = turned(-0.1 * ways[n]);
        report.load[0].pose.translation = {0, 0, 1e-3 * ways[n]};
        curves.add(8 + n, report);
    }
    const std::vector<LoadPeaks> peaks = peaks_of(curves);
    REQUIRE(peaks.size() == 2);
    CHECK(peaks[0].name == "ram");
    CHECK(peaks[0].force.size == 8);
    CHECK(peaks[0].force.frame == 9);  // the first of two alike
    CHECK(peaks[0].torque.size == 1);
    CHECK(peaks[0].torque.frame == 10);
    CHECK(peaks[0].stroke == Approx(4e-3));
    CHECK(peaks[0].turn == Approx(-0.4));
    CHECK(peaks[1].force.size == 0);
    CHECK(peaks[1].stroke == 0);
    CHECK_FALSE(peaks[0].axial);
}

TEST_CASE("of a part that turns the peaks have the torque about its axis, with its sense") {
    const TurnAxis axis{Vec3::UnitZ(), Vec3(0, 0.1, 0)};
    StageCurves curves("s", 7, {{"arm", Pose{}}}, {}, 1, {axis}, {});
    const double forces[] = {10, -30, 20};  // along x, 10 cm from the axis
    for (int n = 0; n < 3; ++n) {
        FrameReport report;
        report.load.resize(1);
        report.load[0].force = {forces[n], 0, 0};
        report.load[0].torque = {0, 99, 0.5};
        curves.add(8 + n, report);
    }
    const LoadPeaks peaks = peaks_of(curves).at(0);
    REQUIRE(peaks.axial);
    CHECK(peaks.axial->size == Approx(-30 * 0.1 + 0.5));
    CHECK(peaks.axial->frame == 9);
    CHECK(peaks.axial->size == curves.load()[0].axial_torque[2]);
}

TEST_CASE("a frame of several legs keeps the deepest that a tool went in") {
    FrameReport frame;
    for (double depth : {1e-4, 3e-4, 2e-4}) {
        FrameReport leg;
        leg.load = {{"ram", Pose{}}};
        leg.load[0].penetration = depth;
        frame.go_on(leg);
    }
    CHECK(frame.load.at(0).penetration == 3e-4);
}

TEST_CASE("the first row has what contacts held at the start, and never a word for a number") {
    FrameReport start;
    start.contact = std::numeric_limits<double>::quiet_NaN();
    StageCurves curves = test::part_curves("s", 1, {{"ram", Pose{}}}, start);
    CHECK(csv_text(curves).find("nan") == std::string::npos);  // before anything was found
    FrameReport report;
    report.load.resize(1);
    report.contact = 0.5, report.contact_at_start = 0.125;
    curves.add(2, report);
    report.contact = 0.75;
    curves.add(3, report);
    CHECK(curves.report()[0].contact == 0.125);
    CHECK(curves.report()[1].contact == 0.5);
    CHECK(lines_of(csv_text(curves))[1].find(",0.125,") != std::string::npos);
}
