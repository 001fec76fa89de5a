// SPDX-License-Identifier: GPL-3.0-or-later
// Kinds of pictures by their first bytes.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace swage {

struct PictureKind {
    std::string_view name, ending;  // "PNG", ".png"
    bool is_read;                   // as a texture
};

// None of what has no such mark, as a TGA.
std::optional<PictureKind> picture_kind(std::string_view bytes);
std::optional<PictureKind> picture_kind_of(const std::filesystem::path& file);

}  // namespace swage
