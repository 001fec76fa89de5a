// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes at a place in an open file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace swage {

// Throws Error(output) of `file`, as users know it.
void write_at(int handle, const std::filesystem::path& file, std::uint64_t offset, const void* data,
              std::size_t size);

// Whether all of it was there to be read.
bool read_at(int handle, std::uint64_t offset, void* data, std::size_t size);

}  // namespace swage
