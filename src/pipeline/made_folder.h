// SPDX-License-Identifier: GPL-3.0-or-later
// Folders that are made for what is to lie in them, and go again where nothing comes to.
#pragma once

#include <filesystem>

namespace swage {

// Makes a folder and those that it lies in; Error(output) when that fails or something else has the
// name.
void make_folder(const std::filesystem::path& folder);

class MadeFolder {
  public:
    // As make_folder().
    explicit MadeFolder(const std::filesystem::path& folder);
    ~MadeFolder();  // of those that it made, what is empty goes
    MadeFolder(const MadeFolder&) = delete;
    MadeFolder& operator=(const MadeFolder&) = delete;

  private:
    void leave();

    std::filesystem::path folder_;     // absolute
    std::filesystem::path outermost_;  // of those that were not there; empty: all were
};

}  // namespace swage
