// SPDX-License-Identifier: GPL-3.0-or-later
// Machine files. key_help.cpp says what each key is for; `swage keys` tells it, with what the key
// takes.
//
// Where a number stands, an expression may stand (see base/expression.h; machine_spec.h says which
// variables it sees); axis and touch are plain numbers. A parameter's range is [low, high].
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "machines/machine_spec.h"
#include "scene/mistake.h"
#include "scene/table_reader.h"

namespace swage {

struct MachineReading {
    std::optional<MachineSpec> machine;  // nothing when there was a mistake (not a warning)
    std::vector<Mistake> mistakes;       // in the order of the file
};

// The machine's name is the stem of the file. Every expression is compiled, so what is left to go
// wrong later are values.
MachineReading read_machine(const std::filesystem::path& file);

// The same of what has been parsed; meshes of tools are relative to `folder`.
void read_machine_document(const Document& document, const std::filesystem::path& folder,
                           Reading& reading, MachineSpec& machine);

}  // namespace swage
