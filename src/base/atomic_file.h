// SPDX-License-Identifier: GPL-3.0-or-later
// Files that appear under their name only when whole: written to a temporary beside the target,
// flushed to disk, renamed.
#pragma once

#include <filesystem>
#include <string_view>

#include "base/file_handle.h"

namespace swage {

// Throws Error(output) naming the file and the reason; leaves no temporary behind.
void write_file_whole(const std::filesystem::path& file, std::string_view bytes);

// The same piece by piece, for files that are more than is to be held at once.
class WholeFile {
  public:
    explicit WholeFile(const std::filesystem::path& file);
    ~WholeFile();  // what was not finished goes
    WholeFile(const WholeFile&) = delete;
    WholeFile& operator=(const WholeFile&) = delete;

    void put(std::string_view bytes);
    void finish();

  private:
    std::filesystem::path file_, temporary_;
    FileHandle handle_;
};

// For files that another program writes: give it `temporary_for(file)`, then `publish` it.
std::filesystem::path temporary_for(const std::filesystem::path& file);
void publish(const std::filesystem::path& temporary, const std::filesystem::path& file);

// A temporary's, of this process or one that is no more.
bool is_left_over(const std::string& name);

// Removes temporaries that the process `pid` has left in a directory tree; 0: this one, and any
// that is no more.
void remove_temporaries(const std::filesystem::path& directory, long pid);

}  // namespace swage
