// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/disk_reserve.h"

#include <fcntl.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/file_handle.h"

namespace swage {

void DiskReserve::hold(const std::filesystem::path& folder, std::uint64_t bytes) {
    release();
    // Named as a temporary, so that it goes with those of a process that was killed.
    const std::filesystem::path file = temporary_for(folder / "reserve");
    const FileHandle handle(::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    if (!handle.is_open()) return;
    file_ = file;
    if (::posix_fallocate(handle.id(), 0, static_cast<off_t>(bytes)) != 0) release();
}

void DiskReserve::release() {
    if (!file_.empty()) ::unlink(file_.c_str());
    file_.clear();
}

}  // namespace swage
