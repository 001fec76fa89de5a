// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace swage::test {

std::string bytes_of(const std::filesystem::path& file);

}  // namespace swage::test
