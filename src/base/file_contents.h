// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

namespace swage {

// A regular file's contents, or nothing where it is none, cannot be read or is longer than that
// [byte]; never blocks on a pipe or device.
std::optional<std::string> file_contents(
    const std::filesystem::path& file,
    std::uint64_t limit = std::numeric_limits<std::uint64_t>::max());

}  // namespace swage
