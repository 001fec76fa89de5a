// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with a command line, and what a mistyped word of it was meant to be.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace swage {

std::string parse_error_text(const CLI::App& app, const CLI::ParseError& error,
                             const std::vector<std::string>& arguments);

}  // namespace swage
