// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <string>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

std::string host_name() {
    std::array<char, 256> name = {};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder) : file_(folder / kName) {
    for (;;) {
        handle_ = FileHandle(::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
        if (!handle_.is_open()) {
            fail(ExitCode::output, "{}: cannot be written: {}", folder.string(),
                 std::strerror(errno));
        }
        const bool ours = ::flock(handle_.id(), LOCK_EX | LOCK_NB) == 0;
        std::array<char, 300> text = {};
        [[maybe_unused]] const ssize_t got = ::pread(handle_.id(), text.data(), text.size() - 1, 0);
        long pid = 0;
        std::string host;
        std::istringstream(text.data()) >> pid >> host;
        if (!ours || (pid != 0 && host != host_name())) {
            // Who has only just begun has not said yet who it is.
            fail(ExitCode::foreign, "{}: {} is writing there{}", folder.string(),
                 pid == 0 ? "another process" : fmt::format("process {} on {}", pid, host),
                 ours ? fmt::format("; if it has died, remove {}", file_.string()) : "");
        }
        // The holder before us may have removed the file between our open and our lock.
        struct stat by_name = {}, by_handle = {};
        if (::stat(file_.c_str(), &by_name) != 0 || ::fstat(handle_.id(), &by_handle) != 0 ||
            by_name.st_ino != by_handle.st_ino) {
            continue;
        }
        if (pid != 0) log_info("{}: taking over from process {}, which died", folder.string(), pid);
        break;
    }
    const std::string mine = fmt::format("{} {}\n", ::getpid(), host_name());
    if (::ftruncate(handle_.id(), 0) != 0 ||
        ::pwrite(handle_.id(), mine.data(), mine.size(), 0) != static_cast<ssize_t>(mine.size())) {
        const int reason = errno;
        ::unlink(file_.c_str());
        fail(ExitCode::output, "{}: cannot be written: {}", file_.string(), std::strerror(reason));
    }
}

FolderLock::~FolderLock() { ::unlink(file_.c_str()); }

bool FolderLock::may_hold(const fs::path& folder) {
    std::error_code unknown;
    return fs::exists(folder / kName, unknown);
}

bool FolderLock::is_all_of(const fs::path& folder) {
    std::error_code error;
    bool all = true;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        const fs::path& file = it->path();
        all = all && (is_lock(file) || is_left_over(file.filename().string()));
    }
    if (error) fail(ExitCode::output, "{}: cannot be read: {}", folder.string(), error.message());
    return all;
}

}  // namespace swage
