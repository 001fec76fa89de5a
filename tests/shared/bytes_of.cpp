// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/shared/bytes_of.h"

#include <fstream>
#include <iterator>

namespace swage::test {

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace swage::test
