// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/file_bytes.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace swage {

namespace fs = std::filesystem;

void write_at(int handle, const fs::path& file, std::uint64_t offset, const void* data,
              std::size_t size) {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
        const ssize_t written = ::pwrite(handle, at, size, static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) {
            fail(ExitCode::output, "{}: cannot be written: {}", file.string(),
                 std::strerror(errno));
        }
        at += written;
        offset += static_cast<std::uint64_t>(written);
        size -= static_cast<std::size_t>(written);
    }
}

bool read_at(int handle, std::uint64_t offset, void* data, std::size_t size) {
    char* at = static_cast<char*>(data);
    while (size > 0) {
        const ssize_t got = ::pread(handle, at, size, static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += got;
        offset += static_cast<std::uint64_t>(got);
        size -= static_cast<std::size_t>(got);
    }
    return true;
}

}  // namespace swage
