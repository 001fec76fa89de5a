// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file_text.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "geometry/mesh_read.h"

namespace swage {

namespace {

// Bytes of the UTF-8 letter at `at`, 0 when there is none (Unicode 15, table 3-7).
std::size_t letter_size(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t n) {
        return at + n < text.size() ? static_cast<unsigned char>(text[at + n]) : 0u;
    };
    const auto follows = [&](std::size_t n, unsigned low = 0x80, unsigned high = 0xBF) {
        return byte(n) >= low && byte(n) <= high;
    };
    const unsigned first = byte(0);
    if (first == 0) return 0;
    if (first < 0x80) return 1;
    if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
    if (first >= 0xE0 && first <= 0xEF) {
        const unsigned low = first == 0xE0 ? 0xA0 : 0x80, high = first == 0xED ? 0x9F : 0xBF;
        return follows(1, low, high) && follows(2) ? 3 : 0;
    }
    if (first >= 0xF0 && first <= 0xF4) {
        const unsigned low = first == 0xF0 ? 0x90 : 0x80, high = first == 0xF4 ? 0x8F : 0xBF;
        return follows(1, low, high) && follows(2) && follows(3) ? 4 : 0;
    }
    return 0;
}

bool check_letters(const std::string& text, const Place& place, MistakeList& mistakes) {
    int line = 1, column = 1;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t size = letter_size(text, at);
        if (size == 0) {
            const unsigned byte = static_cast<unsigned char>(text[at]);
            mistakes.add({place.source, line, column},
                         byte == 0 ? fmt::format("byte {} is 0; this is no text file", at)
                                   : fmt::format("byte {} (0x{:02X}) is not UTF-8; save the file "
                                                 "in that encoding",
                                                 at, byte));
            return false;
        }
        ++column;
        if (text[at] == '\n') {
            ++line;
            column = 1;
        }
        at += size;
    }
    return true;
}

}  // namespace

std::optional<std::string> why_unreadable(const std::filesystem::path& file) {
    struct stat about;
    if (::stat(file.c_str(), &about) != 0) {
        return errno == ENOENT || errno == ENOTDIR
                   ? "does not exist"
                   : std::string("cannot be read: ") + std::strerror(errno);
    }
    if (S_ISDIR(about.st_mode)) return "is a folder, not a file";
    if (!S_ISREG(about.st_mode)) return "is not a plain file";
    if (::access(file.c_str(), R_OK) != 0) {
        return std::string("cannot be read: ") + std::strerror(errno);
    }
    return std::nullopt;
}

std::optional<std::string> why_no_mesh(const std::filesystem::path& file) {
    const std::optional<std::string> reason = why_unreadable(file);
    if (reason || is_mesh_file_name(file)) return reason;
    return fmt::format("is no kind of mesh that can be read: {}", kMeshKinds);
}

std::optional<std::string> read_text(const std::filesystem::path& file, const Place& place,
                                     std::uint64_t limit, MistakeList& mistakes) {
    if (const auto reason = why_unreadable(file)) {
        mistakes.add(place, "the file " + *reason);
        return std::nullopt;
    }
    std::error_code unknown;
    const std::uintmax_t expected = std::filesystem::file_size(file, unknown);
    const int handle = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    std::string text;
    ssize_t size = handle < 0 ? -1 : 1;
    char block[1 << 16];
    while (size > 0 && text.size() <= limit && (unknown || expected <= limit)) {
        size = ::read(handle, block, sizeof block);
        if (size < 0 && errno == EINTR)
            size = 1;
        else if (size > 0)
            text.append(block, static_cast<std::size_t>(size));
    }
    const int error = errno;
    if (handle >= 0) ::close(handle);
    if (size < 0) {
        mistakes.add(place, std::string("the file cannot be read: ") + std::strerror(error));
        return std::nullopt;
    }
    if (text.size() > limit || (!unknown && expected > limit)) {
        mistakes.add(place, fmt::format("the file is larger than {} MiB", limit >> 20));
        return std::nullopt;
    }
    if (!check_letters(text, place, mistakes)) return std::nullopt;
    return text;
}

}  // namespace swage
