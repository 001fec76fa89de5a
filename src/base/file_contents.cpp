// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file_contents.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace swage {

namespace {

std::string cannot_be_read(int error) {
    return std::string("cannot be read: ") + std::strerror(error);
}

}  // namespace

std::optional<std::string> why_unreadable(const std::filesystem::path& file) {
    struct stat about;
    if (::stat(file.c_str(), &about) != 0) {
        return errno == ENOENT || errno == ENOTDIR ? "does not exist" : cannot_be_read(errno);
    }
    if (S_ISDIR(about.st_mode)) return "is a folder, not a file";
    if (!S_ISREG(about.st_mode)) return "is not a regular file";
    if (::access(file.c_str(), R_OK) != 0) return cannot_be_read(errno);
    return std::nullopt;
}

FileHandle open_plain_file(const std::filesystem::path& file, std::string& why) {
    FileHandle handle(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
    const int error = errno;
    struct stat about {};
    if (handle.is_open() && ::fstat(handle.id(), &about) == 0 && S_ISREG(about.st_mode)) {
        return handle;
    }
    why = why_unreadable(file).value_or(cannot_be_read(error));
    return FileHandle();
}

std::optional<std::size_t> read_up_to(int handle, void* data, std::size_t size) {
    std::size_t have = 0;
    while (have < size) {
        const ssize_t got = ::read(handle, static_cast<char*>(data) + have, size - have);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return std::nullopt;
        if (got == 0) break;
        have += static_cast<std::size_t>(got);
    }
    return have;
}

std::optional<std::string> rest_of_file(int handle, std::uint64_t limit, std::string& why) {
    struct stat about {};
    const bool is_known = ::fstat(handle, &about) == 0 && about.st_size > 0;
    const std::uint64_t expected = is_known ? static_cast<std::uint64_t>(about.st_size) : 0;
    std::string bytes;
    std::size_t have = 0;
    // One more than is there shows the end.
    for (std::uint64_t next = expected + 1; have <= limit && expected <= limit; next = 2 * have) {
        bytes.resize(std::max<std::uint64_t>(next, 4096));
        const auto got = read_up_to(handle, bytes.data() + have, bytes.size() - have);
        if (!got) {
            why = cannot_be_read(errno);
            return std::nullopt;
        }
        have += *got;
        if (have == bytes.size()) continue;
        bytes.resize(have);
        if (have <= limit) return bytes;
    }
    why = fmt::format("is larger than {} MiB", limit >> 20);
    return std::nullopt;
}

std::optional<std::string> file_contents(const std::filesystem::path& file, std::uint64_t limit,
                                         std::string* why) {
    std::string reason;
    std::optional<std::string> bytes;
    if (const FileHandle handle = open_plain_file(file, reason); handle.is_open()) {
        bytes = rest_of_file(handle.id(), limit, reason);
    }
    if (why != nullptr) *why = reason;
    return bytes;
}

}  // namespace swage
