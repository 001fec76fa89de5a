// SPDX-License-Identifier: GPL-3.0-or-later
// A file of bytes that is known to be whole and of its kind: a magic word, the bytes, and a hash of
// them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "base/bytes.h"

namespace swage {

// What `write` says, with images, piece by piece: never is all of it held at once. Under its name
// when it is whole. Returns how many bytes that were. Throws Error(output).
std::size_t write_sealed(const std::filesystem::path& file, std::uint64_t magic,
                         const std::function<void(ByteWriter&)>& write);

// Nothing where there is none that is whole, and then `why`, as in "is damaged"; empty: no file.
std::optional<std::string> read_sealed(const std::filesystem::path& file, std::uint64_t magic,
                                       std::string& why);

// The first of the bytes, no more than these, whether the rest is whole or not; empty: no such
// file.
std::string start_of_sealed(const std::filesystem::path& file, std::uint64_t magic,
                            std::size_t most);

}  // namespace swage
