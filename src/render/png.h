// SPDX-License-Identifier: GPL-3.0-or-later
// Picture files: PNG out, PNG and JPEG in.
#pragma once

#include <filesystem>
#include <string>

#include "render/image.h"

namespace swage {

// The same pixels give the same bytes.
std::string encode_png(const Image& image);

// The file stands under its name only when whole. Throws Error(output).
void write_png(const std::filesystem::path& file, const Image& image);

// PNG, JPEG, BMP or TGA; transparency is dropped. Throws Error(output) with the reason when the
// file is missing, broken or larger than `largest_side` pixels.
Image read_image(const std::filesystem::path& file, int largest_side = 16384);
// The same of a file's bytes; `name` is for the reason.
Image decode_image(const std::string& bytes, const std::string& name, int largest_side = 16384);

}  // namespace swage
