// SPDX-License-Identifier: GPL-3.0-or-later
// The plot of a stage's curves, drawn by gnuplot when it is found.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/curves.h"

namespace swage {

// A gnuplot program with its data inside: force above, torque below, each against plot_axis.
std::string plot_program(const StageCurves& curves, const std::filesystem::path& svg);

bool gnuplot_is_present();

// Writes the SVG whole. False when gnuplot failed; its words go to the log.
bool draw_plot(const StageCurves& curves, const std::filesystem::path& svg);

}  // namespace swage
