// SPDX-License-Identifier: GPL-3.0-or-later
// The files within a ZIP file that is held in memory. Both throw Error(mesh).
#pragma once

#include <cstdint>
#include <string>

namespace swage {

// Of the file `name` within; refused where they would be more than `limit` bytes.
std::string zip_contents(const std::string& zip, const std::string& name, std::uint64_t limit);

void replace_in_zip(std::string& zip, const std::string& name, const std::string& contents);

}  // namespace swage
