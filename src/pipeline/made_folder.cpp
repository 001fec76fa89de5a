// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/made_folder.h"

#include "base/error.h"

namespace swage {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
    std::error_code error;
    if (fs::is_directory(folder, error)) return;
    if (fs::exists(folder, error)) {
        fail(ExitCode::output, "{}: is a file, not a directory", folder.string());
    }
    if (!fs::create_directories(folder, error) && error) {
        fail(ExitCode::output, "{}: cannot be created: {}", folder.string(), error.message());
    }
}

MadeFolder::MadeFolder(const fs::path& folder) {
    std::error_code error;
    folder_ = fs::absolute(folder, error);
    if (!folder_.has_filename()) folder_ = folder_.parent_path();
    for (fs::path at = folder_; !at.empty() && !fs::exists(at, error); at = at.parent_path()) {
        outermost_ = at;
    }
    try {
        make_folder(folder);
    } catch (...) {
        leave();
        throw;
    }
}

MadeFolder::~MadeFolder() { leave(); }

void MadeFolder::leave() {
    std::error_code error;  // a folder that is not empty stays
    if (outermost_.empty()) return;
    // Of those that it was to make some may have failed.
    while (folder_ != outermost_ && !fs::exists(folder_, error)) folder_ = folder_.parent_path();
    for (fs::path at = folder_; !outermost_.empty(); at = at.parent_path()) {
        if (!fs::remove(at, error) || at == outermost_) break;
    }
}

}  // namespace swage
