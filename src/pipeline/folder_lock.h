// SPDX-License-Identifier: GPL-3.0-or-later
// A folder that one process at a time writes in, as a file in it says, which the system forgets
// with its holder.
#pragma once

#include <filesystem>

#include "base/file_handle.h"

namespace swage {

class FolderLock {
  public:
    // Throws Error(foreign) while another process holds it, Error(output) when it cannot be
    // written.
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

    static bool is_lock(const std::filesystem::path& file) { return file.filename() == kName; }
    static bool may_hold(const std::filesystem::path& folder);  // the file is there
    // Whether nothing else lies in it. Throws Error(output) when that cannot be read.
    static bool is_all_of(const std::filesystem::path& folder);

  private:
    static constexpr const char* kName = ".swage-lock";

    std::filesystem::path file_;
    FileHandle handle_;
};

}  // namespace swage
