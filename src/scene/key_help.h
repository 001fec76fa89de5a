// SPDX-License-Identifier: GPL-3.0-or-later
// What each key of scene and machine files is for. A test holds it against the keys that their
// readers ask for.
#pragma once

#include <string_view>
#include <vector>

namespace swage {

struct KeyHelp {
    std::string_view section;  // as the reference shows it
    std::string_view key;
    std::string_view help;
    // Instead of what the reader tells; "-": tell nothing.
    std::string_view takes = {}, usual = {};
};

const std::vector<KeyHelp>& scene_key_help();
const std::vector<KeyHelp>& machine_key_help();

}  // namespace swage
