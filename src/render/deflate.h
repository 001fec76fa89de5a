// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes packed for picture files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace swage {

std::string zlib_packed(std::string_view bytes);  // RFC 1950, fast rather than small
std::uint32_t crc32_of(std::string_view bytes);

}  // namespace swage
