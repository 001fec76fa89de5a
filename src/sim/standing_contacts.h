// SPDX-License-Identifier: GPL-3.0-or-later
// What contact between bodies finds of them as they stand.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/contact_sums.h"
#include "sim/settings.h"

namespace swage {

// Of each body; nothing acts on them.
std::vector<ContactSums> standing_contacts(const std::vector<Aggregate*>& bodies,
                                           SimSettings settings);

}  // namespace swage
