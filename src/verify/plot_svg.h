// SPDX-License-Identifier: GPL-3.0-or-later
// Plots of the page as SVG, which its style sheet colours.
#pragma once

#include <string>

#include "verify/case.h"

namespace swage {

std::string escaped(const std::string& text);  // for HTML

// Error against cells across, both logarithmic; dashed: the bounds.
std::string series_svg(const std::string& title, const Series& series);
// Lines of points over a common abscissa.
std::string plot_svg(const Plot& plot);

}  // namespace swage
