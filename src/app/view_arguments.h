// SPDX-License-Identifier: GPL-3.0-or-later
// Options that say where a run is seen from, and where its lamp stands.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/command.h"
#include "render/settings.h"

namespace swage {

struct ViewArguments {
    std::string size, up;
    std::string azimuth, elevation;                        // degrees, or "auto"
    std::optional<double> zoom, turn, field_of_view;       // degrees
    std::optional<double> light_azimuth, light_elevation;  // likewise
    std::vector<double> eye, target;                       // [m]
    bool follow = false, no_follow = false;
    std::vector<std::string> hide;  // names of parts, or "none"
};

// CLI::Range lets "nan" pass.
extern const CLI::Validator kFinite;

void add_view_arguments(CLI::App& command, ViewArguments& given);
// What is given takes the place of what the settings say, and of that alone.
void set_view(const ViewArguments& given, RenderSettings& settings);

}  // namespace swage
