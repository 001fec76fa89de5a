// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/shared/scratch.h"

#include <stdlib.h>

#include <fstream>
#include <stdexcept>

namespace swage::test {

Scratch::Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "swage-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no scratch folder");
    path_ = name;
}

Scratch::~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path Scratch::write(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
}

}  // namespace swage::test
