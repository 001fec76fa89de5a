// SPDX-License-Identifier: GPL-3.0-or-later
// Files that appear under their name only when whole: written to a temporary beside the target,
// flushed to disk, renamed.
#pragma once

#include <filesystem>
#include <string_view>

namespace swage {

// Throws Error(output) naming the file and the reason; leaves no temporary behind.
void write_file_whole(const std::filesystem::path& file, std::string_view bytes);

// For files that another program writes: give it `temporary_for(file)`, then `publish` it.
std::filesystem::path temporary_for(const std::filesystem::path& file);
void publish(const std::filesystem::path& temporary, const std::filesystem::path& file);

}  // namespace swage
