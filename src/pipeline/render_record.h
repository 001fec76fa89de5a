// SPDX-License-Identifier: GPL-3.0-or-later
// How a run is drawn, as run.json says it ("render").
#pragma once

#include <optional>
#include <string>

#include "pipeline/json.h"
#include "render/settings.h"

namespace swage {

Json render_json(const RenderSettings& settings);
// Throws Error(output) when the record of a run holds none.
RenderSettings render_settings_of(const Json& record);

Json passes_json(const std::vector<PicturePass>& passes);
std::optional<PicturePass> pass_named(const std::string& name);
Up up_named(const std::string& name);              // automatic: no such name
GlProviderKind gl_named(const std::string& name);  // likewise
Background background_named(const std::string& name);

}  // namespace swage
