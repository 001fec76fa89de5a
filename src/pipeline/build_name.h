// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace swage {

// Which build this is: a hash of the sources that make a run's results, and of what compiled them,
// made whenever they are compiled (build_name.cmake).
extern const char* const kBuildName;

}  // namespace swage
