// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file_contents.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace swage {

std::optional<std::string> file_contents(const std::filesystem::path& file, std::uint64_t limit) {
    const int handle = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (handle < 0) return std::nullopt;
    struct stat status {};
    std::optional<std::string> contents;
    if (::fstat(handle, &status) == 0 && S_ISREG(status.st_mode) &&
        static_cast<std::uint64_t>(status.st_size) <= limit) {
        std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
        std::size_t have = 0;
        for (ssize_t got; have < bytes.size() &&
                          (got = ::read(handle, bytes.data() + have, bytes.size() - have)) > 0;)
            have += static_cast<std::size_t>(got);
        bytes.resize(have);
        contents = std::move(bytes);
    }
    ::close(handle);
    return contents;
}

}  // namespace swage
