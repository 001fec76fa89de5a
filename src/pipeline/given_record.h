// SPDX-License-Identifier: GPL-3.0-or-later
// What a run was computed with, for run.json: the numbers themselves, in SI units, whatever file or
// default they come from.
#pragma once

#include "matter/material.h"
#include "pipeline/json.h"
#include "scene/spec.h"
#include "sim/settings.h"

namespace swage {

// What never happens, as yield without a yield stress, is null.
Json material_json(const Material& material);

Json settings_json(const SimSettings& settings);

// What the scene gives of the two, across or spacing.
Json mold_json(const MoldSettings& settings);
Json skin_json(const SkinSettings& settings);
// `at_m`: null where its file says it.
Json start_json(const StartSpec& start);
// A box in shares of the work-piece's, or a file.
Json inset_json(const InsetSpec& inset);

}  // namespace swage
