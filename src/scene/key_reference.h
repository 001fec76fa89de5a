// SPDX-License-Identifier: GPL-3.0-or-later
// All keys of scene and machine files, as their readers ask for them.
#pragma once

#include <string>
#include <vector>

namespace swage {

struct KeyReference {
    std::string key;
    std::string takes;  // "length, more than 0 m"
    std::string usual;  // when it is left out; empty: nothing is to tell
    std::string help;   // empty: key_help.cpp does not know the key
};

struct SectionReference {
    std::string section;  // "[mesh]", "[[stage]]"
    std::vector<KeyReference> key;
};

std::vector<SectionReference> scene_key_reference();
std::vector<SectionReference> machine_key_reference();

// What stands in expressions, of which `key` holds the writing and `help` the meaning.
SectionReference expression_reference();

// The units that numbers may have: `key` holds the quantity, `help` its units.
SectionReference unit_reference();

}  // namespace swage
