// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "geometry/box.h"
#include "matter/aggregate.h"

namespace swage {

struct NamedMatter {
    std::string name;
    const Aggregate* matter;
    Box skin{};  // of its skin, as place_work_frame() has it
};

}  // namespace swage
