// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plot.h"

#include <fstream>
#include <sstream>

#include "base/process.h"
#include "tests/catch.h"
#include "tests/pipeline/scratch.h"

using namespace swage;

namespace {

StageCurves squeeze(const std::string& name) {
    StageCurves curves(name, 1, {{"ram's head", Pose{}}, {"idle_roller", Pose{}}});
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
    const std::string program = plot_program(squeeze("1-squeeze"), "out.svg");
    CHECK(program.find("travel of ram''s head [mm]") != std::string::npos);
    CHECK(program.find("[N]") != std::string::npos);
    CHECK(program.find("idle_roller") == std::string::npos);
    CHECK(program.find("N m") == std::string::npos);
    CHECK(program.find("5 50\n") != std::string::npos);
}

TEST_CASE("gnuplot draws every plot, an empty one too") {
    if (!gnuplot_is_present()) {
        WARN("skipped: gnuplot is not installed");
        return;
    }
    const Scratch scratch;
    const std::filesystem::path svg = scratch.path() / "it's a plot.svg";
    for (const StageCurves& curves :
         {squeeze("1-squeeze"), StageCurves("2-rest", 6, {{"ram", Pose{}}})}) {
        REQUIRE(draw_plot(curves, svg));
        std::ifstream in(svg);
        std::stringstream text;
        text << in.rdbuf();
        CHECK(text.str().find("<svg") != std::string::npos);
        CHECK(text.str().find(curves.stage()) != std::string::npos);
        CHECK(text.str().find("</svg>") != std::string::npos);
    }
}
