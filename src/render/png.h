// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures as PNG files.
#pragma once

#include <filesystem>
#include <string>

#include "render/image.h"

namespace swage {

// The same pixels give the same bytes.
std::string encode_png(const Image& image);

// The file stands under its name only when whole. Throws Error(output).
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace swage
