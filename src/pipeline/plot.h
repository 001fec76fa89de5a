// SPDX-License-Identifier: GPL-3.0-or-later
// The plot of a stage's curves, drawn by gnuplot when it is found.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/curves.h"

namespace swage {

struct StagePlot {
    std::string name;     // of its file, but for the ending: the stage's
    std::string program;  // for gnuplot, with the data inside; where it goes is told beside it
};

// Force above, torque below, each against plot_axis. Of a work-piece of this size [m]: torques that
// its forces make by a lever of no more than two thousandths of it are left out, and forces that
// are as small beside torques.
StagePlot plot_of(const StageCurves& curves, double size);

bool gnuplot_is_present();

// Writes the SVG whole. What kept it from that, and stands in the log then; empty: nothing, or
// somebody who asked the process to end.
std::string draw_plot(const StagePlot& plot, const std::filesystem::path& svg);

}  // namespace swage
