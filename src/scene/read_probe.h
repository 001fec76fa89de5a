// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <string>

#include "scene/spec.h"
#include "scene/table_reader.h"

namespace swage {

// One [[probe]] of a scene, into the body that it names. `names`: of those before it.
void read_probe(TableReader& table, std::set<std::string>& names, SceneSpec& scene);

// Probes and parts of machines share the columns of a table; told at the [[probe]].
void refuse_probes_named_as_parts(TableReader& root, const SceneSpec& scene);

}  // namespace swage
