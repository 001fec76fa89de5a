// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "matter/aggregate.h"

namespace swage {

struct NamedMatter {
    std::string name;
    const Aggregate* matter;
};

}  // namespace swage
