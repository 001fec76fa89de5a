// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures from files of any usual kind.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "render/image.h"

namespace swage {

// PNG, JPEG, BMP or TGA; transparency is dropped. Throws Error(output) with the reason when the
// file is missing, broken or larger than `largest_side` pixels.
Image read_image(const std::filesystem::path& file, int largest_side = 16384);
// The same of a file's bytes; `name` is for the reason.
Image decode_image(const std::string& bytes, const std::string& name, int largest_side = 16384);

// Width and height as the picture's header has them; none where it cannot be read.
std::optional<std::array<int, 2>> picture_size(const std::filesystem::path& file);
std::optional<std::array<int, 2>> picture_size(const std::string& bytes);

}  // namespace swage
