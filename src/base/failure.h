// SPDX-License-Identifier: GPL-3.0-or-later
// What an exception that swage did not throw itself means to the user.
#pragma once

#include <exception>
#include <optional>

#include "base/error.h"

namespace swage {

// An Error as it is; of too little memory or too few threads one of resources, of a file that
// cannot be reached one of output. Nothing for what else there is, mistakes in swage itself.
std::optional<Error> failure_of(const std::exception& error);

}  // namespace swage
