// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace swage {

// "load wind", and "load_1" of one that has no name of its own.
inline std::string load_name(const std::string& name) {
    return (name.starts_with("load") ? "" : "load ") + name;
}

}  // namespace swage
