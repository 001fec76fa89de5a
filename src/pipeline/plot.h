// SPDX-License-Identifier: GPL-3.0-or-later
// The plot of a stage's curves, drawn by gnuplot when it is found.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/curves.h"

namespace swage {

// A gnuplot program with its data inside: force above, torque below, each against plot_axis. Of a
// work-piece of this size [m]: torques that its forces make by a lever of no more than two
// thousandths of it are left out, and forces that are as small beside torques.
std::string plot_program(const StageCurves& curves, double size, const std::filesystem::path& svg);

bool gnuplot_is_present();

// Writes the SVG whole. What kept it from that, and stands in the log then; empty: nothing.
std::string draw_plot(const StageCurves& curves, double size, const std::filesystem::path& svg);

}  // namespace swage
