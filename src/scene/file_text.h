// SPDX-License-Identifier: GPL-3.0-or-later
// Files before they are understood: whether they can be read at all, and whether they are text.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "base/file_contents.h"  // why_unreadable
#include "scene/document.h"

namespace swage {

// As why_unreadable(), of one that has to be a mesh, of a kind that can be read.
std::optional<std::string> why_no_mesh(const std::filesystem::path& file);

// Likewise, of one that has to be a picture that can be drawn on a mesh.
std::optional<std::string> why_no_texture(const std::filesystem::path& file);

// The whole file. Reports and gives nothing when it cannot be read, is larger than `limit` or holds
// bytes that are no UTF-8 text.
std::optional<std::string> read_text(const std::filesystem::path& file, const Place& place,
                                     std::uint64_t limit, MistakeList& mistakes);
// The same of standard input, to its end.
std::optional<std::string> read_standard_input(const Place& place, std::uint64_t limit,
                                               MistakeList& mistakes);

}  // namespace swage
