// SPDX-License-Identifier: GPL-3.0-or-later
// What each key of scene and machine files is for. A test holds it against the keys that their
// readers ask for.
#pragma once

#include <span>
#include <string_view>

namespace swage {

struct KeyHelp {
    std::string_view section;  // as the reference shows it
    std::string_view key;
    std::string_view help;
    // Instead of what the reader tells; "-": tell nothing.
    std::string_view takes = {}, usual = {};
};

std::span<const KeyHelp> scene_key_help();
std::span<const KeyHelp> machine_key_help();

}  // namespace swage
