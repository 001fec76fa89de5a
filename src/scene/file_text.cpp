// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/file_text.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/interrupt.h"
#include "geometry/mesh_read.h"
#include "geometry/picture_kind.h"

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
                         byte == 0 ? fmt::format("byte {} is 0; this is not a text file", at)
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

std::optional<std::string> checked(std::optional<std::string> text, const std::string& why,
                                   const Place& place, MistakeList& mistakes) {
    if (!text) mistakes.add(place, why);
    if (!text || !check_letters(*text, place, mistakes)) return std::nullopt;
    return text;
}

}  // namespace

std::optional<std::string> why_no_mesh(const std::filesystem::path& file) {
    const std::optional<std::string> reason = why_unreadable(file);
    if (reason || is_mesh_file_name(file)) return reason;
    return fmt::format("is not a mesh format that can be read: {}", kMeshKinds);
}

std::optional<std::string> why_no_texture(const std::filesystem::path& file) {
    if (const std::optional<std::string> reason = why_unreadable(file)) return reason;
    const std::optional<PictureKind> kind = picture_kind_of(file);
    if (!kind || kind->is_read) return std::nullopt;
    return fmt::format("is of type {}: it must be PNG, JPEG, BMP or TGA", kind->name);
}

std::optional<std::string> read_text(const std::filesystem::path& file, const Place& place,
                                     std::uint64_t limit, MistakeList& mistakes) {
    std::string why;
    std::optional<std::string> text = file_contents(file, limit, &why);
    return checked(std::move(text), "the file " + why, place, mistakes);
}

std::optional<std::string> read_standard_input(const Place& place, std::uint64_t limit,
                                               MistakeList& mistakes) {
    constexpr int kPatience = 200;  // [ms] until a look at whether somebody wants to stop
    std::string text;
    for (std::string part(std::size_t{64} << 10, 0); text.size() <= limit;) {
        throw_if_interrupted();
        pollfd input{STDIN_FILENO, POLLIN, 0};
        if (::poll(&input, 1, kPatience) <= 0) continue;
        const ssize_t got = ::read(STDIN_FILENO, part.data(), part.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            const std::string why = std::strerror(errno);
            return checked(std::nullopt, "standard input cannot be read: " + why, place, mistakes);
        }
        if (got == 0) return checked(std::move(text), "", place, mistakes);
        text.append(part, 0, static_cast<std::size_t>(got));
    }
    return checked(std::nullopt, fmt::format("standard input is larger than {} MiB", limit >> 20),
                   place, mistakes);
}

}  // namespace swage
