// SPDX-License-Identifier: GPL-3.0-or-later
// What was verified, as a table and as one page that needs nothing beside it.
#pragma once

#include <string>
#include <vector>

#include "verify/case.h"

namespace swage {

struct Verified {
    Case verification;
    Result result;
};

std::string verified_text(const std::vector<Verified>& all);
// A row a case, for a README: of each resolution the value that comes closest to its bound.
std::string verified_markdown(const std::vector<Verified>& all);
std::string verified_page(const std::vector<Verified>& all);

}  // namespace swage
