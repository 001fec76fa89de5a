// SPDX-License-Identifier: GPL-3.0-or-later
// What a run was computed with, for run.json: the numbers themselves, in SI units, whatever file or
// default they come from.
#pragma once

#include "matter/material.h"
#include "pipeline/json.h"
#include "sim/settings.h"

namespace swage {

// What never happens, as yield without a yield stress, is null.
Json material_json(const Material& material);

Json settings_json(const SimSettings& settings);

}  // namespace swage
