// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/material.h"
#include "scene/table_reader.h"

namespace swage {

// Whether a stress is given as inf: a number, or in quotes, with a unit or without. So a scene
// turns a material that yields or breaks into one that does not.
bool is_infinite(const Node* node);

// The keys yield_stress, hardening and flow_curve of a material, over what `material` has of them.
void read_flow(TableReader& table, Material& material);

}  // namespace swage
