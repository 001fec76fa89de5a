// SPDX-License-Identifier: GPL-3.0-or-later
// What comes after the cases of motion on a floor: a ball on it.
#pragma once

#include <vector>

#include "verify/case.h"

namespace swage {

void add_contact_cases(std::vector<Case>& cases);

}  // namespace swage
