// SPDX-License-Identifier: GPL-3.0-or-later
// Plain files, read whole. Nothing here blocks on a pipe or device, and what cannot be read is
// never taken for the end of a file. Reasons go on from the file's name: "does not exist", "is a
// folder, not a file", "cannot be read: Permission denied".
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "base/file_handle.h"

namespace swage {

inline constexpr std::uint64_t kAnyLength = std::numeric_limits<std::uint64_t>::max();

// Nothing where the file could be read. Never opens it.
std::optional<std::string> why_unreadable(const std::filesystem::path& file);

// Not open where it is no plain file or cannot be opened; `why` then says so.
FileHandle open_plain_file(const std::filesystem::path& file, std::string& why);

// The next bytes of a file, fewer than `size` at its end only; nothing, and errno, where it cannot
// be read.
std::optional<std::size_t> read_up_to(int handle, void* data, std::size_t size);

// All that follows; nothing where it cannot be read or is longer than that [byte].
std::optional<std::string> rest_of_file(int handle, std::uint64_t limit, std::string& why);

// A plain file's contents, or nothing and, where asked for, `why`.
std::optional<std::string> file_contents(const std::filesystem::path& file,
                                         std::uint64_t limit = kAnyLength,
                                         std::string* why = nullptr);

}  // namespace swage
