// SPDX-License-Identifier: GPL-3.0-or-later
// An empty folder that goes away with the test.
#pragma once

#include <filesystem>
#include <string>

namespace swage::test {

class Scratch {
  public:
    Scratch();
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    std::filesystem::path write(const std::string& name, const std::string& bytes) const;

  private:
    std::filesystem::path path_;
};

}  // namespace swage::test

using swage::test::Scratch;
