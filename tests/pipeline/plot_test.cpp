// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plot.h"

#include "base/atomic_file.h"
#include "base/process.h"
#include "tests/catch.h"
#include "tests/pipeline/part_curves.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

StageCurves squeeze(const std::string& name) {
    StageCurves curves =
        test::part_curves(name, 1, {{"ram's head", Pose{}}, {"idle_roller", Pose{}}});
    for (int f = 1; f <= 5; ++f) {
        FrameReport report;
        report.load.resize(2);
        report.load[0].pose.translation = {0, -0.001 * f, 0};
        report.load[0].force = {0, -10.0 * f, 0};
        curves.add(1 + f, report);
    }
    return curves;
}

}  // namespace

TEST_CASE("a plot shows what was felt, names its axes with units, and nothing else") {
    const std::string program = plot_program(squeeze("1-squeeze"), 0.1);
    CHECK(program.find("stroke of ram''s head [mm]") != std::string::npos);
    CHECK(program.find("[N]") != std::string::npos);
    CHECK(program.find("idle_roller") == std::string::npos);
    CHECK(program.find("N m") == std::string::npos);
    CHECK(program.find("5 50\n") != std::string::npos);
}

TEST_CASE("a plot leaves out what is nothing beside the rest: torques of forces, and the reverse") {
    const double size = 0.1;
    const auto program = [&](double force, double torque) {
        StageCurves curves = test::part_curves("1-press", 1, {{"ram", Pose{}}});
        FrameReport report;
        report.load.resize(1);
        report.load[0].force = {0, -force, 0};
        report.load[0].torque = {torque, 0, 0};
        curves.add(2, report);
        return plot_program(curves, size);
    };
    const auto shows = [](const std::string& program, const char* unit) {
        return program.find(unit) != std::string::npos;
    };
    CHECK(shows(program(1e4, 10), "[N m]"));
    CHECK(shows(program(1e4, 10), "[N]"));
    CHECK_FALSE(shows(program(1e4, 1), "[N m]"));
    CHECK_FALSE(shows(program(1e-3, 1), "[N]"));
    CHECK(shows(program(1e4, 0), "[N]"));
    CHECK(shows(program(0, 1), "[N m]"));
}

TEST_CASE("of what turns about a known axis a plot shows the torque about that alone") {
    StageCurves curves("1-twist", 1, {{"chuck", Pose{}}}, {}, 1,
                       {TurnAxis{Vec3::UnitX(), Vec3::Zero()}}, {});
    FrameReport report;
    report.load.resize(1);
    report.load[0].torque = {-3, 4, 0};
    curves.add(2, report);
    const std::string program = plot_program(curves, 0.1);
    INFO(program);
    CHECK(program.find(" 3\n") != std::string::npos);
    CHECK(program.find(" 5\n") == std::string::npos);
}

TEST_CASE("gnuplot draws every plot, an empty one too") {
    if (!program_exists("gnuplot")) {
        WARN("skipped: gnuplot is not installed");
        return;
    }
    const Scratch scratch;
    const std::filesystem::path svg = scratch.path() / "it's a plot.svg";
    const std::filesystem::path program = scratch.path() / "it's a plot.gp";
    for (const StageCurves& curves :
         {squeeze("1-squeeze"), test::part_curves("2-rest", 6, {{"ram", Pose{}}})}) {
        Plots plots(scratch.path(), {"none", "it's a plot"});
        CHECK_FALSE(plots.has_undrawn());
        write_file_whole(program, plot_program(curves, 0.1));
        CHECK(plots.has_undrawn());
        plots.draw();
        CHECK(plots.warnings().empty());
        CHECK_FALSE(std::filesystem::exists(program));
        const std::string text = test::bytes_of(svg);
        CHECK(text.find("<svg") != std::string::npos);
        CHECK(text.find(curves.stage()) != std::string::npos);
        CHECK(text.find("</svg>") != std::string::npos);
    }
}
