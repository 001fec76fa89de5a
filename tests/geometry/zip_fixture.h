// SPDX-License-Identifier: GPL-3.0-or-later
// ZIP files, as 3MF is packed.
#pragma once

#include "tests/geometry/mesh_fixtures.h"

namespace swage::test {

inline std::uint32_t crc32(const std::string& bytes) {
    std::uint32_t crc = ~0u;
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
    }
    return ~crc;
}

// A ZIP file of files that are stored as they are, or as blocks of a packed stream.
inline std::string zip_of(const std::vector<std::pair<std::string, std::string>>& files,
                          bool packed = false) {
    std::string bytes, directory;
    for (const auto& [name, content] : files) {
        const auto size = static_cast<std::uint32_t>(content.size());
        const auto length = static_cast<std::uint16_t>(size);
        const std::string held =
            packed ? '\1' + raw(length) + raw(static_cast<std::uint16_t>(~length)) + content
                   : content;
        const std::string common =
            raw<std::uint16_t>(20) + raw<std::uint16_t>(0) + raw<std::uint16_t>(packed ? 8 : 0) +
            raw<std::uint32_t>(0x21) + raw(crc32(content)) +
            raw(static_cast<std::uint32_t>(held.size())) + raw(size) +
            raw(static_cast<std::uint16_t>(name.size())) + raw<std::uint16_t>(0);
        directory += raw<std::uint32_t>(0x02014b50) + raw<std::uint16_t>(20) + common +
                     std::string(10, '\0') + raw(static_cast<std::uint32_t>(bytes.size())) + name;
        bytes += raw<std::uint32_t>(0x04034b50) + common + name + held;
    }
    const auto count = static_cast<std::uint16_t>(files.size());
    return bytes + directory + raw<std::uint32_t>(0x06054b50) + raw<std::uint32_t>(0) + raw(count) +
           raw(count) + raw(static_cast<std::uint32_t>(directory.size())) +
           raw(static_cast<std::uint32_t>(bytes.size())) + raw<std::uint16_t>(0);
}

// The same as lib3mf writes it: every size and place is given in 64 bits, in an extra field.
inline std::string zip64_of(const std::vector<std::pair<std::string, std::string>>& files) {
    constexpr std::uint32_t kElsewhere = 0xffffffff;
    std::string bytes, directory;
    for (const auto& [name, content] : files) {
        const std::uint64_t size = content.size(), at = bytes.size();
        const std::string common = raw<std::uint16_t>(45) + raw<std::uint16_t>(0) +
                                   raw<std::uint16_t>(0) + raw<std::uint32_t>(0x21) +
                                   raw(crc32(content)) + raw(kElsewhere) + raw(kElsewhere) +
                                   raw(static_cast<std::uint16_t>(name.size()));
        const auto extra = [](std::uint16_t length) { return raw<std::uint16_t>(1) + raw(length); };
        directory += raw<std::uint32_t>(0x02014b50) + raw<std::uint16_t>(45) + common +
                     raw<std::uint16_t>(28) + std::string(10, '\0') + raw(kElsewhere) + name +
                     extra(24) + raw(size) + raw(size) + raw(at);
        bytes += raw<std::uint32_t>(0x04034b50) + common + raw<std::uint16_t>(20) + name +
                 extra(16) + raw(size) + raw(size) + content;
    }
    const std::uint64_t count = files.size(), size = directory.size(), at = bytes.size();
    const auto short_count = static_cast<std::uint16_t>(count);
    return bytes + directory + raw<std::uint32_t>(0x06064b50) + raw<std::uint64_t>(44) +
           raw<std::uint16_t>(45) + raw<std::uint16_t>(45) + raw<std::uint64_t>(0) + raw(count) +
           raw(count) + raw(size) + raw(at) + raw<std::uint32_t>(0x07064b50) +
           raw<std::uint32_t>(0) + raw(at + size) + raw<std::uint32_t>(1) +
           raw<std::uint32_t>(0x06054b50) + raw<std::uint32_t>(0) + raw(short_count) +
           raw(short_count) + raw(static_cast<std::uint32_t>(size)) + raw(kElsewhere) +
           raw<std::uint16_t>(0);
}

}  // namespace swage::test
