// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/material.h"
#include "scene/table_reader.h"

namespace swage {

// The keys back_stress and back_strain of a material, over what `material` has of them, once its
// elasticity and its flow are read.
void read_back_stress(TableReader& table, Material& material);

}  // namespace swage
